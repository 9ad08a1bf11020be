"""Conan 2 recipe: conan create bindings/packaging/conan"""
import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class HmfRecipe(ConanFile):
    name = "hmf"
    package_type = "library"
    license = "MIT"
    author = "hmf contributors"
    description = "Harmonic measured foliations on triangle meshes: conformal parameterization, quad meshes, stripe patterns"
    topics = ("geometry-processing", "mesh", "foliation", "parameterization", "remeshing")
    settings = "os", "compiler", "build_type", "arch"
    options = {"shared": [True, False], "fPIC": [True, False]}
    default_options = {"shared": False, "fPIC": True}
    implements = ["auto_shared_fpic"]

    @property
    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..", "..")

    def set_version(self):
        header = load(self, os.path.join(self._root, "include", "hmf", "hmf.h"))
        parts = ("MAJOR", "MINOR", "PATCH")
        self.version = ".".join(re.search(rf"#define HMF_VERSION_{part} (\d+)", header)[1] for part in parts)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "include/*", "src/*"):
            copy(self, pattern, self._root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HMF_BUILD_CLI"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["hmf"]
        self.cpp_info.set_property("cmake_file_name", "hmf")
        self.cpp_info.set_property("cmake_target_name", "hmf::hmf")
        self.cpp_info.set_property("pkg_config_name", "hmf")
        if self.settings.os in ("Linux", "FreeBSD"):
            self.cpp_info.system_libs = ["stdc++", "m"]
        if self.options.shared:
            self.cpp_info.defines = ["HMF_SHARED"]

//! Compiles the C++ sources of hmf into this crate.
//!
//! They lie in `core/`: in the repository behind symbolic links, in a package as
//! files. Where a checkout has no symbolic links (Windows), the repository
//! itself is taken.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let root = [here.join("core"), here.join("../../..")]
        .into_iter()
        .find(|root| root.join("src/core").is_dir() && root.join("include/hmf/hmf.h").is_file())
        .ok_or("the C++ sources of hmf are missing; take the whole repository or the published crate")?
        .canonicalize()?;
    let (sources, include) = (root.join("src"), root.join("include"));

    let mut build = cc::Build::new();
    build
        .cpp(true)
        .std("c++17")
        .include(&include)
        .files(cpp_files(&sources.join("core"))?)
        .files(cpp_files(&sources.join("applications"))?)
        // The core is as fast in a debug build of Rust: it dominates the time.
        .opt_level(3)
        .define("NDEBUG", None)
        .flag_if_supported("-fvisibility=hidden")
        .flag_if_supported("-fno-exceptions")
        .flag_if_supported("-fno-rtti")
        // No contraction: the same bits on machines with and without FMA.
        .flag_if_supported("-ffp-contract=off");
    if build.get_compiler().is_like_msvc() {
        build.flag("/fp:precise");
    }
    // Documentation needs no library; docs.rs sets this, and the reference site.
    println!("cargo:rerun-if-env-changed=DOCS_RS");
    if env::var_os("DOCS_RS").is_none() {
        build.try_compile("hmf")?;
    }

    println!("cargo:rerun-if-changed={}", sources.display());
    println!("cargo:rerun-if-changed={}", include.display());
    // DEP_HMF_INCLUDE for build scripts of crates that compile C against hmf.h.
    println!("cargo:include={}", include.display());
    println!("cargo:rustc-env=HMF_HEADERS={}", include.display());
    Ok(())
}

/// All files `*.cpp` below a folder, sorted.
fn cpp_files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(cpp_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "cpp") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

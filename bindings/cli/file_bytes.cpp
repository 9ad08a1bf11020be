#include "file_bytes.hpp"

#include "read_mesh.hpp"

#if defined(__unix__) || defined(__APPLE__)
#define HMF_HAS_MMAP
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace cli {

FileBytes::FileBytes(const std::string& path) {
#ifdef HMF_HAS_MMAP
    struct stat status;
    if (stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
        const size_t size = static_cast<size_t>(status.st_size);
        const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
        void* const map = file < 0 ? MAP_FAILED : mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
        if (file >= 0) close(file);
        if (map != MAP_FAILED) {
            map_ = map;
            view_ = std::string_view(static_cast<const char*>(map), size);
            return;
        }
    }
#endif
    copy_ = read_file(path);
    view_ = copy_;
}

FileBytes::~FileBytes() {
#ifdef HMF_HAS_MMAP
    if (map_) munmap(map_, view_.size());
#endif
}

} // namespace cli

// The bytes of a file, mapped if the system can: a large file is then neither copied nor held twice. The file must not
// be truncated while it is mapped.
#pragma once

#include <string>
#include <string_view>

namespace cli {

class FileBytes {
public:
    // Throws Failure(EXIT_RESOURCES) when it cannot be read.
    explicit FileBytes(const std::string& path);
    ~FileBytes();
    FileBytes(const FileBytes&) = delete;
    FileBytes& operator=(const FileBytes&) = delete;

    std::string_view view() const { return view_; }

private:
    std::string_view view_;
    std::string copy_; // of what cannot be mapped
    void* map_ = nullptr;
};

} // namespace cli

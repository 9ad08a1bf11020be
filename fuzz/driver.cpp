// Runs a fuzz target without libFuzzer, so that every compiler and valgrind
// can replay a corpus in the ordinary test run.
//
//     NAME_replay [FILE or FOLDER]...  [--random N SEED]
//
// Every input lies in a block of exactly its size: a read beyond its end is
// seen by the address sanitizer and by valgrind.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "bytes.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

using fuzz::next_random;

void run(const std::vector<uint8_t>& bytes) {
    std::unique_ptr<uint8_t[]> block(new uint8_t[bytes.size()]);
    std::copy(bytes.begin(), bytes.end(), block.get());
    LLVMFuzzerTestOneInput(block.get(), bytes.size());
}

// Half of the inputs are small numbers, which get further into a parser.
std::vector<uint8_t> random_input(uint64_t& state) {
    const size_t size = static_cast<size_t>(next_random(state) % (next_random(state) % 2 ? 64 : 2048));
    const bool small = next_random(state) % 2 != 0;
    std::vector<uint8_t> bytes(size);
    for (uint8_t& b : bytes) {
        const uint64_t r = next_random(state);
        b = static_cast<uint8_t>(small ? (r % 4 ? 0 : (r >> 8) % 16) : r);
    }
    return bytes;
}

bool replay(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        std::fprintf(stderr, "cannot read %s\n", path.string().c_str());
        return false;
    }
    run(std::vector<uint8_t>(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()));
    return true;
}

} // namespace

int main(int argc, char** argv) {
    unsigned long long replayed = 0, random = 0;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--random")) {
            if (i + 2 >= argc) {
                std::fprintf(stderr, "usage: %s [FILE or FOLDER]... [--random N SEED]\n", argv[0]);
                return 2;
            }
            const unsigned long long count = std::strtoull(argv[i + 1], nullptr, 10);
            uint64_t state = std::strtoull(argv[i + 2], nullptr, 10);
            i += 2;
            for (unsigned long long k = 0; k < count; ++k) run(random_input(state));
            random += count;
            continue;
        }
        const std::filesystem::path path(argv[i]);
        std::error_code failure;
        if (!std::filesystem::is_directory(path, failure)) {
            if (!replay(path)) return 2;
            ++replayed;
            continue;
        }
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::directory_iterator(path))
            if (entry.is_regular_file()) files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        for (const auto& file : files) {
            if (!replay(file)) return 2;
            ++replayed;
        }
    }
    std::printf("%llu inputs replayed, %llu random inputs run\n", replayed, random);
    return 0;
}

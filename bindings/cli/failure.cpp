#include "failure.hpp"

namespace cli {

static const char* element_name(int32_t element) {
    switch (element) {
    case HMF_ELEMENT_VERTEX: return "vertex";
    case HMF_ELEMENT_EDGE: return "edge";
    case HMF_ELEMENT_TRIANGLE: return "triangle";
    case HMF_ELEMENT_LOOP: return "loop";
    case HMF_ELEMENT_LEVEL: return "level";
    case HMF_ELEMENT_OPTION: return "option";
    default: return nullptr;
    }
}

static ExitStatus exit_status_of(hmf_status status) {
    if (status >= HMF_LIMIT_ITERATIONS && status <= HMF_CANCELLED) return EXIT_LIMIT;
    if (status >= 300 && status < 600) return EXIT_BAD_INPUT;
    if (status == HMF_ERROR_OPTIONS || status == HMF_ERROR_UNSUPPORTED) return EXIT_USAGE;
    return EXIT_RESOURCES;
}

void fail_with(hmf_status status, const hmf_error& error, const std::string& subject) {
    std::string sentence = subject + ": " + hmf_status_string(status);
    if (error.status == status) {
        if (const char* name = element_name(error.element))
            sentence += std::string(" (") + name + " " + std::to_string(error.index) + ")";
        if (error.message[0]) sentence += std::string(": ") + error.message;
    }
    throw Failure(exit_status_of(status), sentence);
}

} // namespace cli

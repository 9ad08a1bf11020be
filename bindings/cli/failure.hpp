// How a command of the tool ends early: an exit status and a sentence.
#pragma once

#include <hmf/hmf.h>

#include <functional>
#include <stdexcept>
#include <string>

namespace cli {

enum ExitStatus : int {
    EXIT_SOLVED = 0,
    EXIT_USAGE = 2,
    EXIT_BAD_INPUT = 3,
    EXIT_LIMIT = 4,
    EXIT_RESOURCES = 5,
};

struct Failure : std::runtime_error {
    ExitStatus exit_status;
    Failure(ExitStatus status, const std::string& sentence) : std::runtime_error(sentence), exit_status(status) {}
};

// How sentences name an element of a mesh, HMF_ELEMENT_TRIANGLE or HMF_ELEMENT_VERTEX: "face 3, line 17", or without
// its line.
using Naming = std::function<std::string(int32_t element, uint64_t index, bool with_line)>;

// Throws what a status of the library means for the caller of the tool.
// subject: the file that the element of the error belongs to.  advice: follows the sentence.  naming: of elements in
// errors of meshes; else by their numbers.
[[noreturn]] void fail_with(hmf_status status, const hmf_error& error, const std::string& subject,
                            const std::string& advice = "", const Naming& naming = nullptr);

// A sentence of the library with the options of the tool; without what is of the C interface.
std::string in_words_of_tool(std::string message);

// "Triangle 5 (4, 8, 5) has no area." by the names of the file: "Face 3 has no area."
std::string in_names_of_file(const std::string& message, const Naming& naming);

// --mollify where --repair meets triangles without area.
constexpr double MOLLIFY_OF_REPAIR = 1e-5;
constexpr const char* MOLLIFIED = "accepted triangles without area (--mollify 1e-5)";

// What --repair and --join-points would do about a mesh that is refused with this status, after a semicolon; "" where
// they were given, or do not help.
std::string repair_advice(hmf_status status, bool repairs, bool joins);

// Why a solve with a foliation ended early.
std::string limit_sentence(hmf_status status, const hmf_error& error);

} // namespace cli

#include "failure.hpp"

#include <utility>

namespace cli {

static const char* element_name(int32_t element) {
    switch (element) {
    case HMF_ELEMENT_VERTEX: return "vertex";
    case HMF_ELEMENT_EDGE: return "edge";
    case HMF_ELEMENT_TRIANGLE: return "triangle";
    case HMF_ELEMENT_LOOP: return "loop";
    case HMF_ELEMENT_LEVEL: return "level";
    default: return nullptr; // also of options: their numbers are those of the C interface
    }
}

static ExitStatus exit_status_of(hmf_status status) {
    if (status >= HMF_LIMIT_ITERATIONS && status <= HMF_LIMIT_CLASS) return EXIT_LIMIT;
    if (status >= 300 && status < 600) return EXIT_BAD_INPUT;
    if (status == HMF_ERROR_UNSUPPORTED || status == HMF_ERROR_QUADS) return EXIT_BAD_INPUT;
    if (status == HMF_ERROR_OPTIONS) return EXIT_USAGE;
    return EXIT_RESOURCES;
}

// The library speaks to programmers; here its advice names the options of the tool.
static const std::pair<std::string, std::string> words_of_tool[] = {
    {"set mollify in the build options", "give --mollify 1e-5"},
    {"raise mollify", "raise --mollify"},
    {"Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", "Give --loops cut or --loops pants"},
    {"use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", "give --loops cut or --loops pants"},
    {"Improve the values with hmf_relax", "Give --method newton, or a smaller --tolerance"},
    {"Improve them with hmf_relax", "Give --method newton, or a smaller --tolerance"},
    {"; hmf_singularities lists them", ""},
    {"Start from hmf_foliation_from_loops or a result of hmf_solve", "Give a file that --values has written"},
    {"Mark four vertices or more", "Give --marks auto, or a file of four vertices or more"},
    {"; report->class_state tells whether the values are in it", ""},
    {"Try another ratio", "Give another --ratio"},
    {"edge_length", "--size"}};

// Sentences with a name of the C interface that no option corresponds to say nothing here.
static bool is_of_c(const std::string& sentence) {
    for (const char* word : {"_", "NULL", "->", "options"})
        if (sentence.find(word) != std::string::npos) return true;
    return false;
}

std::string in_words_of_tool(std::string message) {
    for (const auto& [library, tool] : words_of_tool)
        if (const size_t at = message.find(library); at != std::string::npos) message.replace(at, library.size(), tool);
    std::string kept;
    for (size_t begin = 0; begin < message.size();) {
        size_t end = message.find(". ", begin);
        end = end == std::string::npos ? message.size() : end + 2;
        const std::string sentence = message.substr(begin, end - begin);
        begin = end;
        if (!is_of_c(sentence)) kept += sentence;
    }
    while (!kept.empty() && kept.back() == ' ') kept.pop_back();
    return kept;
}

std::string repair_advice(hmf_status status, bool repairs, bool joins) {
    const auto unless_given = [&](const char* text) { return repairs ? "" : text; };
    switch (status) {
    case HMF_ERROR_MESH_REPEATED_VERTEX: return unless_given("; --repair drops such triangles");
    case HMF_ERROR_MESH_DEGENERATE: return unless_given("; --repair accepts such triangles");
    case HMF_ERROR_MESH_ORIENTATION: return unless_given("; --repair turns patches to one sense");
    case HMF_ERROR_MESH_NON_MANIFOLD_VERTEX:
    case HMF_ERROR_MESH_NON_MANIFOLD_EDGE:
        return unless_given("; --repair drops duplicate triangles and takes sheets apart that touch there");
    case HMF_ERROR_MESH_BOUNDARY: return joins ? "" : "; --repair --join-points joins vertices at the same point";
    default: return "";
    }
}

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

size_t end_of_number(const std::string& text, size_t at) {
    while (at < text.size() && is_digit(text[at])) ++at;
    return at;
}

// Of a noun without its first letter, at this place of a message; where its numbers begin, or 0.
size_t numbers_behind(const std::string& message, size_t at, const std::string& noun) {
    if (message.compare(at, noun.size(), noun) != 0) return 0;
    at += noun.size();
    return at < message.size() && is_digit(message[at]) ? at : 0;
}

} // namespace

std::string in_names_of_file(const std::string& message, const Naming& naming) {
    static const std::pair<const char*, int32_t> nouns[] = {{"riangles ", HMF_ELEMENT_TRIANGLE},
                                                            {"riangle ", HMF_ELEMENT_TRIANGLE},
                                                            {"ertices ", HMF_ELEMENT_VERTEX},
                                                            {"ertex ", HMF_ELEMENT_VERTEX}};
    std::string text;
    for (size_t at = 0; at < message.size();) {
        int32_t element = HMF_ELEMENT_NONE;
        size_t number = 0;
        for (const auto& [noun, kind] : nouns)
            if (!element && (number = numbers_behind(message, at + 1, noun)) > 0) element = kind;
        if (!element) {
            text += message[at++];
            continue;
        }
        const bool is_capital = message[at] >= 'A' && message[at] <= 'Z';
        const size_t begin = text.size();
        for (bool again = true; again;) {
            const size_t end = end_of_number(message, number);
            text += naming(element, std::stoull(message.substr(number, end - number)), false);
            at = end;
            again = message.compare(at, 5, " and ") == 0 && at + 5 < message.size() && is_digit(message[at + 5]);
            if (again) text += " and ";
            number = at + 5;
        }
        if (is_capital) text[begin] = static_cast<char>(text[begin] - 'a' + 'A');
        // "The triangles 3 and 4" are "face 1 and face 2".
        if (text.compare(begin > 4 ? begin - 4 : 0, 4, "The ") == 0 && begin >= 4)
            text.replace(begin - 4, 5, std::string(1, static_cast<char>(text[begin] - 'a' + 'A')));
        // Corners are named by numbers that the file may not have.
        if (element == HMF_ELEMENT_TRIANGLE && message.compare(at, 2, " (") == 0 && at + 2 < message.size()
            && is_digit(message[at + 2]))
            at = message.find(')', at) + 1;
    }
    return text;
}

void fail_with(hmf_status status, const hmf_error& error, const std::string& subject, const std::string& advice,
               const Naming& naming) {
    if (status == HMF_CANCELLED) throw Failure(EXIT_LIMIT, subject + ": interrupted before there was a result");
    std::string sentence = subject + ": " + hmf_status_string(status);
    if (error.status == status) {
        const bool is_named = naming && (error.element == HMF_ELEMENT_TRIANGLE || error.element == HMF_ELEMENT_VERTEX);
        if (is_named) sentence += " (" + naming(error.element, error.index, true) + ")";
        else if (const char* name = element_name(error.element))
            sentence += std::string(" (") + name + " " + std::to_string(error.index) + ")";
        const std::string said = in_words_of_tool(error.message);
        const std::string message = naming ? in_names_of_file(said, naming) : said;
        // "Not available" says less than why.
        if (!message.empty() && status == HMF_ERROR_UNSUPPORTED) sentence = subject + ": " + message;
        else if (!message.empty()) sentence += ": " + message;
    }
    if (!advice.empty() && sentence.back() == '.') sentence.pop_back();
    throw Failure(exit_status_of(status), sentence + advice);
}

std::string limit_sentence(hmf_status status, const hmf_error& error) {
    if (status == HMF_CANCELLED) return "interrupted";
    std::string sentence = hmf_status_string(status);
    // Of the other limits the status says it all; here the error names the loop.
    if (status == HMF_LIMIT_CLASS && error.status == status) sentence += ": " + in_words_of_tool(error.message);
    while (sentence.back() == '.') sentence.pop_back();
    return sentence;
}

} // namespace cli

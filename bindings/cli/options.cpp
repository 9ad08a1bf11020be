#include "options.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "failure.hpp"
#include "read_mesh.hpp"

namespace cli {

namespace {

std::vector<std::string> words_of(const char* text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
    return text;
}

bool is_optional_number(const Option& o) { return std::holds_alternative<std::optional<double>*>(o.target); }

bool is_number(const std::string& word) {
    char* end = nullptr;
    std::strtod(word.c_str(), &end);
    return !word.empty() && *end == '\0';
}

[[noreturn]] void refuse_usage(const std::string& sentence) { throw Failure(EXIT_USAGE, sentence); }

Option* find(Options& options, const std::string& name) {
    const auto at = std::find_if(options.begin(), options.end(), [&](const Option& o) { return name == o.name; });
    return at == options.end() ? nullptr : &*at;
}

// Letters to put in, leave out or exchange.
size_t letters_between(const std::string& a, const std::string& b) {
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (size_t i = 1; i <= a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const size_t other = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = std::min(other, std::min(row[j], row[j - 1]) + 1);
        }
    }
    return row[b.size()];
}

// What may have been meant: an option that begins so, or one with two other letters at most.
std::string advice(const Options& options, const std::string& name) {
    const Option* best = nullptr;
    size_t least = 3;
    for (const Option& o : options) {
        const std::string known = o.name;
        const bool begins =
            name.size() > 3 && (known.compare(0, name.size(), name) == 0 || name.compare(0, known.size(), known) == 0);
        const size_t distance = o.by_place() ? least : begins ? 0 : letters_between(name, known);
        if (distance >= least) continue;
        least = distance;
        best = &o;
    }
    return best ? "; " + std::string(best->name) + " is one" : "";
}

double number_of(const Option& o, const std::string& word) {
    char* end = nullptr;
    const double x = std::strtod(word.c_str(), &end);
    if (word.empty() || *end) refuse_usage(std::string(o.name) + ": \"" + word + "\" is not a number");
    if (o.range[0]) {
        const std::string range = o.range;
        const double low = std::strtod(o.range + 1, &end), high = std::strtod(end + 1, nullptr);
        const bool above = range.front() == '(' ? x > low : x >= low,
                   below = range.back() == ')' ? x < high : x <= high;
        if (!above || !below) refuse_usage(std::string(o.name) + ": " + word + " is not in " + range);
    }
    return x;
}

struct Set {
    const Option& o;
    const std::string& word;

    void operator()(bool* target) const { *target = true; }
    void operator()(double* target) const { *target = number_of(o, word); }
    void operator()(std::optional<double>* target) const { *target = number_of(o, word); }
    void operator()(std::string* target) const { *target = word; }
    void operator()(std::vector<std::string>* target) const { target->push_back(word); }
    void operator()(uint64_t* target) const {
        const std::from_chars_result parsed = std::from_chars(word.data(), word.data() + word.size(), *target);
        if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size())
            refuse_usage(
                std::string(o.name) + ": \"" + word
                + (parsed.ec == std::errc::result_out_of_range ? "\" is too large" : "\" is not a whole number"));
        if (o.range[0]) number_of(o, word);
    }
    void operator()(std::vector<double>* target) const {
        std::istringstream stream(word + ","); // what follows the last comma is a number as well
        for (std::string part; std::getline(stream, part, ',');) target->push_back(number_of(o, part));
    }
    void operator()(const Choice& choice) const {
        std::vector<std::string> names;
        for (const auto& [name, value] : choice.names) {
            if (word == name) {
                *choice.target = value;
                return;
            }
            names.push_back(name);
        }
        refuse_usage(std::string(o.name) + ": \"" + word + "\" is none of its values; give " + joined(names));
    }
};

struct Get {
    using Value = readers::Json;
    const Option& o;

    Value operator()(const bool* target) const { return *target; }
    Value operator()(const uint64_t* target) const { return *target; }
    Value operator()(const double* target) const { return *target != 0 ? Value(*target) : Value(); }
    Value operator()(const std::optional<double>* target) const { return *target ? Value(**target) : Value(); }
    Value operator()(const std::string* target) const { return target->empty() ? Value() : Value(*target); }
    template <class T>
    Value operator()(const std::vector<T>* target) const {
        return *target;
    }
    Value operator()(const Choice& choice) const {
        for (const auto& [name, value] : choice.names)
            if (value == *choice.target) return name;
        return {};
    }
};

// An .obj has others beside it, a .glb is one file.
std::vector<std::string> beside(const Option& o, const std::string& path) {
    return extension_of(path) == ".glb" ? std::vector<std::string>{} : words_of(o.beside);
}

void check_file(const Option& o, const std::string& path) {
    if (path == "-") {
        if (o.beside[0])
            refuse_usage(std::string(o.name)
                         + ": writes several files, which do not fit into standard output; give a name");
        return;
    }
    const std::vector<std::string> extensions = words_of(o.extensions);
    if (!extensions.empty() && std::count(extensions.begin(), extensions.end(), extension_of(path)) == 0)
        refuse_usage(std::string(o.name) + ": \"" + path + "\" must end in " + joined(extensions));
}

// The options that write a file, or one beside theirs, each with its name.
std::string writers_of(const Options& options, const std::string& path) {
    std::vector<std::string> writers;
    for (const Option& o : options)
        for (const std::string& given : o.role == Option::OUTPUT ? o.given : std::vector<std::string>{}) {
            if (given == path) writers.emplace_back(o.name);
            for (const std::string& extension : beside(o, given))
                if (with_extension(given, extension) == path) writers.push_back(std::string(o.name) + " " + given);
        }
    std::string text;
    for (const std::string& writer : writers) text += (text.empty() ? "" : " and by ") + writer;
    return text;
}

void check_files(const Options& options) {
    std::vector<std::string> inputs;
    for (const Option& o : options)
        for (const std::string& path : o.given) {
            if (o.role != Option::SETTING) check_file(o, path);
            if (o.role == Option::INPUT) inputs.push_back(path);
        }
    if (std::count(inputs.begin(), inputs.end(), "-") > 1)
        refuse_usage("-: standard input can be read once only; give files for the other inputs");
    const std::vector<std::string> outputs = outputs_of(options);
    for (size_t i = 0; i < outputs.size(); ++i) {
        if (std::count(outputs.begin(), outputs.end(), outputs[i]) > 1)
            refuse_usage(outputs[i] + ": is written by " + writers_of(options, outputs[i]) + "; give two names");
        for (const std::string& input : inputs) {
            std::error_code code;
            if (outputs[i] != "-" && (outputs[i] == input || std::filesystem::equivalent(outputs[i], input, code)))
                refuse_usage(outputs[i] + ": is an input as well; give another name to the output");
        }
    }
}

} // namespace

void parse(Options& options, const std::vector<std::string>& words, const std::string& command) {
    const std::string help = "; hmf " + command + " --help lists the options";
    for (size_t i = 0; i < words.size(); ++i) {
        std::string name = words[i], value;
        const bool is_name = name.size() > 1 && name[0] == '-';
        const size_t equals = is_name ? name.find('=') : std::string::npos;
        if (equals != std::string::npos) {
            value = name.substr(equals + 1);
            name.resize(equals);
        }
        Option* option = nullptr;
        if (is_name) option = find(options, name);
        else
            for (Option& o : options)
                if (!option && o.by_place() && o.given.empty()) option = &o;
        if (!option && is_name) refuse_usage("there is no option " + name + advice(options, name) + help);
        if (!option) refuse_usage("nothing is expected here: " + name + help);
        if (!option->given.empty() && !std::holds_alternative<std::vector<std::string>*>(option->target))
            refuse_usage(name + ": is given twice; give it once");
        if (!is_name) value = name;
        else if (option->is_flag()) {
            if (equals != std::string::npos) refuse_usage(name + ": takes no value");
        } else if (equals == std::string::npos && is_optional_number(*option)) {
            value = i + 1 < words.size() && is_number(words[i + 1]) ? words[++i] : "0";
        } else if (equals == std::string::npos) {
            if (i + 1 == words.size() || words[i + 1].rfind("--", 0) == 0)
                refuse_usage(name + ": a value is missing; write " + name + " " + option->value);
            value = words[++i];
        }
        std::visit(Set{*option, value}, option->target);
        option->given.push_back(value);
    }
    for (const Option& o : options) {
        if (o.by_place() && !o.optional && o.given.empty()) refuse_usage(std::string(o.name) + " is missing" + help);
        if (o.given.empty()) continue;
        bool can_be_there = false, is_there = false;
        for (const std::string& needed : words_of(o.needs))
            if (const Option* other = find(options, needed)) {
                can_be_there = true;
                is_there = is_there || !other->given.empty();
            }
        if (can_be_there && !is_there)
            refuse_usage(std::string(o.name) + ": has no effect without " + joined(words_of(o.needs))
                         + "; give that as well");
        for (const std::string& other : words_of(o.excludes))
            if (const Option* p = find(options, other); p && !p->given.empty())
                refuse_usage(std::string(o.name) + ": does not go together with " + other + "; give one of them");
    }
    check_files(options);
}

std::string description_of(const Option& o) {
    std::string text = o.help;
    if (o.range[0]) text += std::string(", in ") + o.range;
    const readers::Json value = std::visit(Get{o}, o.target);
    if (value.text() || value.is_number()) text += " (default " + (value.text() ? *value.text() : value.dump()) + ")";
    return text;
}

void print_help(const Options& options, const std::string& command, const std::string& about) {
    std::printf("%s\n\nusage: hmf %s", about.c_str(), command.c_str());
    for (const Option& o : options)
        if (o.by_place()) std::printf(o.optional ? " [%s]" : " %s", o.name);
    std::printf(" [OPTIONS]\n\n");
    for (const Option& o : options) {
        const std::string text = description_of(o);
        const std::string head = std::string("  ") + o.name + (o.by_place() || o.is_flag() ? "" : " ") + o.value;
        std::printf("%s", head.c_str());
        if (head.size() > 26) std::printf("\n%*s", 28, "");
        else std::printf("%*s", static_cast<int>(28 - head.size()), "");
        for (const char c : text) c == '\n' ? std::printf("\n%*s", 28, "") : std::putchar(c);
        std::printf("\n");
    }
}

readers::Json values_of(const Options& options) {
    readers::Json all = {};
    for (const Option& o : options)
        if (!o.by_place() && (o.role != Option::OUTPUT || !o.given.empty()))
            all.set(o.name + 2, std::visit(Get{o}, o.target));
    return all;
}

std::vector<std::string> outputs_of(const Options& options) {
    std::vector<std::string> outputs;
    for (const Option& o : options)
        if (o.role == Option::OUTPUT)
            for (const std::string& path : o.given) {
                outputs.push_back(path);
                for (const std::string& extension : beside(o, path)) outputs.push_back(with_extension(path, extension));
            }
    return outputs;
}

std::string with_extension(const std::string& path, const std::string& extension) {
    return std::filesystem::path(path).replace_extension(extension).string();
}

} // namespace cli

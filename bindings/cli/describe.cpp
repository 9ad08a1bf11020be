#include "describe.hpp"

#include <sstream>

namespace cli {

namespace {

struct Table {
    Options options;
    std::string command, about;
    std::vector<std::string> descriptions; // of the options, whose targets are gone later
};

std::vector<Table> tables_of(const DescribeAll& all) {
    std::vector<Table> tables;
    all([&](const Options& options, const std::string& command, const std::string& about) {
        tables.push_back({options, command, about, {}});
        for (const Option& o : options) tables.back().descriptions.push_back(description_of(o));
    });
    return tables;
}

// The words that a value can be; for --loops all kinds except FILE.
std::string words_of_value(const Option& o) {
    std::string words;
    if (const Choice* const choice = std::get_if<Choice>(&o.target)) {
        for (const auto& [name, value] : choice->names) words += (words.empty() ? "" : " ") + std::string(name);
        return words;
    }
    std::istringstream stream(o.value);
    for (std::string word; std::getline(stream, word, '|');)
        if (!word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string::npos)
            words += (words.empty() ? "" : " ") + word;
    return words;
}

bool takes_file(const Option& o) { return o.role != Option::SETTING; }

std::string one_line(const char* text) {
    std::string line = text;
    for (char& c : line)
        if (c == '\n') c = ' ';
    return line;
}

std::string quoted(const std::string& text, const char* special) { // in single quotes
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') out += "'\\''";
        else {
            for (const char* s = special; *s; ++s)
                if (c == *s) out += '\\';
            out += c;
        }
    }
    return out + "'";
}

std::string bash(const std::vector<Table>& tables) {
    std::string out = "# bash completion of hmf, made by: hmf completion bash\n"
                      "_hmf() {\n"
                      "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words= files=1\n"
                      "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
                      "        words='";
    for (const Table& t : tables) out += t.command + " ";
    out += "--help --version' files=\n    else\n        case ${COMP_WORDS[1]} in\n";
    for (const Table& t : tables) {
        out += "        " + t.command + ")\n            case $before in\n";
        std::string names;
        for (const Option& o : t.options) {
            if (o.by_place()) {
                names += words_of_value(o) + " ";
                continue;
            }
            names += std::string(o.name) + " ";
            if (o.is_flag()) continue;
            out += "            " + std::string(o.name) + ") words='" + words_of_value(o) + "'"
                 + (takes_file(o) ? "" : " files=") + " ;;\n";
        }
        out += "            *) words='" + names + "--help' ;;\n            esac\n            ;;\n";
    }
    return out
         + "        esac\n    fi\n"
           "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\"; [ -z \"$files\" ] || compgen -f -- "
           "\"$word\")\n"
           "}\n"
           "complete -o filenames -F _hmf hmf\n";
}

std::string zsh(const std::vector<Table>& tables) {
    std::string out = "#compdef hmf\n# zsh completion of hmf, made by: hmf completion zsh\n_hmf() {\n"
                      "    local -a commands=(\n";
    for (const Table& t : tables) out += "        " + quoted(t.command + ":" + one_line(t.about.c_str()), "") + "\n";
    out += "    )\n    if (( CURRENT == 2 )); then\n        _describe command commands\n        return\n    fi\n"
           "    local command=${words[2]}\n    shift words\n    (( CURRENT-- ))\n    case $command in\n";
    for (const Table& t : tables) {
        out += "    " + t.command + ")\n        _arguments";
        for (const Option& o : t.options) {
            const std::string words = words_of_value(o);
            std::string action = takes_file(o) ? "_files" : words.empty() ? "" : "(" + words + ")";
            if (takes_file(o) && !words.empty())
                action = "{_alternative \"words:word:(" + words + ")\" \"files:file:_files\"}";
            std::string value = o.value;
            for (char& c : value)
                if (c == ':') c = ' ';
            if (o.by_place()) {
                out += " \\\n            "
                     + quoted(std::string(":") + o.name + ":" + (words.empty() ? "_files" : action), "");
                continue;
            }
            std::string spec = std::string(o.name) + "[";
            for (const char c : one_line(o.help))
                spec += c == '[' || c == ']' ? std::string("\\") + c : c == ':' ? "\\:" : std::string(1, c);
            spec += "]";
            if (!o.is_flag()) spec += ":" + value + ":" + action;
            out += " \\\n            " + quoted(spec, "");
        }
        out += "\n        ;;\n";
    }
    return out + "    esac\n}\n_hmf \"$@\"\n";
}

std::string fish(const std::vector<Table>& tables) {
    std::string out = "# fish completion of hmf, made by: hmf completion fish\n";
    for (const Table& t : tables)
        out += "complete -c hmf -n __fish_use_subcommand -f -a " + t.command + " -d "
             + quoted(one_line(t.about.c_str()), "\\") + "\n";
    for (const Table& t : tables)
        for (const Option& o : t.options) {
            const std::string when = "complete -c hmf -n '__fish_seen_subcommand_from " + t.command + "'";
            const std::string words = words_of_value(o);
            if (o.by_place()) {
                if (!words.empty()) out += when + " -f -a '" + words + "'\n";
                continue;
            }
            out += when + " -l " + (o.name + 2) + " -d " + quoted(one_line(o.help), "\\");
            if (!o.is_flag()) out += takes_file(o) ? " -r" : " -x";
            if (!words.empty()) out += " -a '" + words + "'";
            out += "\n";
        }
    return out;
}

// Roff: a minus that can be copied, and no line that begins with a point.
std::string roff(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '\\') out += "\\e";
        else if (c == '-') out += "\\-";
        else out += c;
    }
    return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

} // namespace

std::string completion(Shell shell, const DescribeAll& all) {
    const std::vector<Table> tables = tables_of(all);
    return shell == Shell::bash ? bash(tables) : shell == Shell::zsh ? zsh(tables) : fish(tables);
}

std::string manual_page(const std::string& version, const DescribeAll& all) {
    std::string out =
        ".TH HMF 1 \"\" \"hmf " + version
        + "\" \"User Commands\"\n.SH NAME\nhmf \\- harmonic measured foliations on triangle meshes\n.SH SYNOPSIS\n";
    const std::vector<Table> tables = tables_of(all);
    for (const Table& t : tables) {
        out += ".B hmf " + t.command + "\n";
        for (const Option& o : t.options)
            if (o.by_place()) out += o.optional ? "[" + roff(o.name) + "]\n" : ".I " + roff(o.name) + "\n";
        out += "[\\fIOPTIONS\\fR]\n.br\n";
    }
    out +=
        ".SH DESCRIPTION\nComputes harmonic measured foliations on triangle meshes, closed or with boundary (spheres "
        "and disks with marked vertices), and from them conformal parameterizations, quad meshes and stripe patterns.\n"
        ".SH COMMANDS\n";
    for (const Table& t : tables) {
        out += ".SS hmf " + t.command + "\n" + roff(t.about) + "\n";
        for (size_t i = 0; i < t.options.size(); ++i) {
            const Option& o = t.options[i];
            out += ".TP\n\\fB" + roff(o.name) + "\\fR";
            if (!o.by_place() && !o.is_flag()) out += " \\fI" + roff(o.value) + "\\fR";
            out += "\n" + roff(one_line(t.descriptions[i].c_str())) + "\n";
        }
    }
    return out
         + ".SH EXIT STATUS\n0 solved; 2 usage; 3 bad input, or not supported for it; 4 limit reached before "
           "convergence "
           "(the best foliation so far is written); 5 out of memory or file error.\n"
           ".SH EXAMPLES\n.nf\nhmf demo\nhmf solve mesh.obj \\-\\-image mesh.png\n"
           "hmf solve mesh.obj \\-\\-quads quads.obj \\-\\-size 0.5\n.fi\n";
}

} // namespace cli

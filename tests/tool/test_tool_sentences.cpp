// Sentences of the tool for what no mesh is known to lead to.
#include "bindings/cli/failure.cpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace test_tool_sentences {

namespace {

hmf_error error_of(hmf_status status, const char* message) {
    hmf_error error{status, HMF_ELEMENT_LOOP, 3, {}};
    std::snprintf(error.message, sizeof error.message, "%s", message);
    return error;
}

void expect_words_of_tool(const std::string& sentence) {
    for (const char* word : {"hmf_", "HMF_", "report->", "class_state", "options"})
        EXPECT_EQ(sentence.find(word), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("class of the loops"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("Give another --ratio"), std::string::npos) << sentence;
    EXPECT_NE(sentence.back(), '.') << sentence;
}

// What the library can say: the literals of each call that fails.
std::vector<std::string> sentences_of_library() {
    const std::filesystem::path sources = std::filesystem::path(__FILE__).parent_path() / "../../src";
    std::vector<std::string> found;
    std::error_code code;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(sources, code)) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
        std::ostringstream text;
        text << std::ifstream(entry.path()).rdbuf();
        const std::string source = text.str();
        for (size_t at = 0; (at = source.find("fail(", at)) != std::string::npos; ++at) {
            std::string sentence;
            bool quoted = false;
            for (size_t i = at; quoted || source[i] != ';'; ++i)
                if (source[i] == '"') quoted = !quoted;
                else if (quoted) sentence += source[i];
            if (!sentence.empty()) found.push_back(sentence);
        }
    }
    return found;
}

} // namespace

TEST(ToolSentences, EveryErrorOfTheLibraryIsInItsWords) {
    const std::vector<std::string> all = sentences_of_library();
    if (all.empty()) GTEST_SKIP() << "the sources of the library are not here";
    EXPECT_GT(all.size(), 100u);
    for (const std::string& sentence : all) {
        const std::string said = cli::in_words_of_tool(sentence);
        EXPECT_TRUE(std::all_of(said.begin(), said.end(), [](char c) { return c != '_'; })) << sentence << ": " << said;
        EXPECT_EQ(said.find("NULL"), std::string::npos) << said;
    }
    // A sentence that the library no longer says has no place in the table.
    for (const auto& [library, tool] : cli::words_of_tool)
        EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&words = library](const std::string& one) {
            return one.find(words) != std::string::npos;
        })) << library;
}

TEST(ToolSentences, LimitOfTheClassNamesTheLoop) {
    const std::string sentence = cli::limit_sentence(
        HMF_LIMIT_CLASS, error_of(HMF_LIMIT_CLASS, "Steps to the minimum leave the class: the cylinder of loop 3 would "
                                                   "be 2 high instead of 1. The values are in the class. Try another "
                                                   "ratio, or improve the triangles."));
    expect_words_of_tool(sentence);
    EXPECT_NE(sentence.find("loop 3 would be 2 high instead of 1"), std::string::npos) << sentence;
}

TEST(ToolSentences, LimitOfTheClassWithoutALoop) {
    expect_words_of_tool(cli::limit_sentence(
        HMF_LIMIT_CLASS,
        error_of(HMF_LIMIT_CLASS, "Steps to the minimum leave the class of the loops; report->class_state tells "
                                  "whether the values are in it. Try another ratio, or improve the triangles.")));
}

TEST(ToolSentences, OtherLimits) {
    const hmf_error none{};
    EXPECT_EQ(cli::limit_sentence(HMF_CANCELLED, none), "interrupted");
    EXPECT_EQ(cli::limit_sentence(HMF_LIMIT_TIME, none), hmf_status_string(HMF_LIMIT_TIME));
    EXPECT_EQ(cli::limit_sentence(HMF_LIMIT_CLASS, none), hmf_status_string(HMF_LIMIT_CLASS));
}

TEST(ToolSentences, LimitsEndWithFour) {
    for (hmf_status status = HMF_LIMIT_ITERATIONS; status <= HMF_LIMIT_CLASS; ++status) {
        try {
            cli::fail_with(status, error_of(status, ""), "mesh.obj");
        } catch (const cli::Failure& failure) { EXPECT_EQ(failure.exit_status, cli::EXIT_LIMIT) << status; }
    }
}

} // namespace test_tool_sentences

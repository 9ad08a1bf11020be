// Sentences of the tool for what no mesh is known to lead to.
#include "bindings/cli/failure.cpp"

#include <gtest/gtest.h>

#include <cstdio>

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

} // namespace

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

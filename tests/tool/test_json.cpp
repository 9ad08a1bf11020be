// JSON of the readers and the tool.

#include <gtest/gtest.h>

#include <json.hpp>
#include <limits>
#include <string>

namespace test_json {

namespace {

using readers::Json;
using readers::JsonError;
using readers::parse_json;

TEST(Json, ReadsAndWrites) {
    for (const std::string text :
         {"null", "true", "false", "0", "18446744073709551615", "-9223372036854775808", "1.5", "-0.0", "1e+300", "\"\"",
          "[]", "{}", "[1,[2,[]],{\"a\":{}}]", "{\"b\":1,\"a\":[true,null]}", "\"\\\"\\\\\\n\\u0001/\"",
          "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\""})
        EXPECT_EQ(parse_json(" \t\r\n" + text + "\n ").dump(), text);
    EXPECT_EQ(parse_json("\"\\u00e4\\u20ac\\ud83d\\ude00\\/\"").dump(), "\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80/\"");
    EXPECT_EQ(parse_json("[1E2,0.10,1e-5,18446744073709551616,-0]").dump(),
              "[100.0,0.1,1e-05,18446744073709551616.0,-0.0]");
    EXPECT_EQ(parse_json("[1,{\"a\":2}]").dump(1), "[\n 1,\n {\n  \"a\": 2\n }\n]");
    EXPECT_EQ(parse_json("1e-999").number(), 0);
}

TEST(Json, RefusesWhatIsNone) {
    for (const std::string text : {"",
                                   " ",
                                   "nul",
                                   "truee",
                                   "01",
                                   "+1",
                                   ".5",
                                   "1.",
                                   "1e",
                                   "1e+",
                                   "-",
                                   "--1",
                                   "0x1",
                                   "NaN",
                                   "Infinity",
                                   "'a'",
                                   "\"",
                                   "\"\\\"",
                                   "\"\\x\"",
                                   "\"\\u12\"",
                                   "\"\\u12g4\"",
                                   "\"\\ud800\"",
                                   "\"\\ud800\\u0041\"",
                                   "\"\\udc00\"",
                                   "\"\x01\"",
                                   "\"\n\"",
                                   "\"\xff\"",
                                   "\"\xc0\x80\"",
                                   "\"\xed\xa0\x80\"",
                                   "\"\xf4\x90\x80\x80\"",
                                   "\"\xe2\x82\"",
                                   "[",
                                   "[1",
                                   "[1,",
                                   "[1,]",
                                   "[,1]",
                                   "[1 2]",
                                   "]",
                                   "{",
                                   "{\"a\"",
                                   "{\"a\":",
                                   "{\"a\":1",
                                   "{\"a\":1,",
                                   "{\"a\":1,}",
                                   "{a:1}",
                                   "{1:1}",
                                   "{\"a\" 1}",
                                   "1 2",
                                   "[]]",
                                   "1e999",
                                   "-1e999",
                                   "// comment\n1"})
        EXPECT_THROW(parse_json(text), JsonError) << text;
    EXPECT_THROW(parse_json(std::string("\0", 1)), JsonError);
    EXPECT_THROW(parse_json(std::string("\"\0\"", 3)), JsonError);
    try {
        parse_json("{\"a\":\n [1, x]}");
        FAIL();
    } catch (const JsonError& error) { EXPECT_EQ(error.byte, 11u); }
    const auto nested = [](size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_NO_THROW(parse_json(nested(64)));
    EXPECT_THROW(parse_json(nested(66)), JsonError);
    EXPECT_THROW(parse_json(std::string(1000000, '[')), JsonError);
}

TEST(Json, FindsMembers) {
    std::string text = "{";
    for (int k = 0; k < 100; ++k)
        text += "\"m" + std::to_string(k * 7 % 100) + "\":" + std::to_string(k * 7 % 100) + ",";
    const Json large = parse_json(text + "\"m5\":-1}"), small = parse_json("{\"a\":1,\"b\":2,\"a\":3}");
    for (int k = 0; k < 100; ++k) {
        const Json* const found = large.find("m" + std::to_string(k));
        ASSERT_TRUE(found);
        EXPECT_EQ(found->number(), k == 5 ? -1 : k); // the last of its name
    }
    EXPECT_FALSE(large.find("m"));
    EXPECT_FALSE(large.find("m100"));
    EXPECT_EQ(small.find("a")->number(), 3);
    EXPECT_FALSE(Json(1).find("a"));
    EXPECT_TRUE(Json("a").elements().empty());
}

TEST(Json, Values) {
    EXPECT_EQ(*parse_json("7").whole(), 7u);
    for (const char* text : {"-7", "7.0", "7e0", "\"7\"", "18446744073709551616"})
        EXPECT_FALSE(parse_json(text).whole()) << text;
    EXPECT_EQ(parse_json("-7").number(), -7);
    EXPECT_FALSE(parse_json("\"7\"").is_number());
    EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).dump(), "null");
    EXPECT_EQ(Json("\xff"
                   "a")
                  .dump(),
              "\"\xef\xbf\xbd"
              "a\"");
    Json object = {{"n", size_t{3}}, {"list", std::vector<double>{0.1, 2}}, {"i", -1}};
    object.set("n", "three");
    object.set("new", Json());
    EXPECT_EQ(object.dump(), "{\"n\":\"three\",\"list\":[0.1,2.0],\"i\":-1,\"new\":null}");
}

} // namespace

} // namespace test_json

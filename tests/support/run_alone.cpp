// The main function of the test programs: behind each case that fails stands the line that runs it alone. What ends the
// program itself is known from its last case and its path, which is printed first.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace {

class RunAlone : public testing::EmptyTestEventListener {
public:
    explicit RunAlone(const char* program) : program_(program) {}
    void OnTestEnd(const testing::TestInfo& test) override {
        if (!test.result()->Failed()) return;
        std::printf("run it alone: %s --gtest_filter=%s.%s\n", program_.c_str(), test.test_suite_name(), test.name());
        std::fflush(stdout);
    }

private:
    std::string program_;
};

} // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    std::printf("program: %s\n", argv[0]);
    testing::UnitTest::GetInstance()->listeners().Append(new RunAlone(argv[0]));
    return RUN_ALL_TESTS();
}

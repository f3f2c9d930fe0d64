// Counts the test cases that were entered and skipped, for the exit code.
#include "possible.hpp"

#include <doctest/doctest.h>

#include <cstdio>

namespace hive::test {

namespace {

constexpr int all_skipped = 77;  // as SKIP_RETURN_CODE in tests/CMakeLists.txt

int entered = 0, skipped = 0;
bool this_one_is = false;

/// Is notified of every start of a case, also of repetitions for subcases.
class Entries : public doctest::IReporter {
public:
    explicit Entries(const doctest::ContextOptions& /*options*/) {}
    void test_case_start(const doctest::TestCaseData& /*data*/) override { enter(); }
    void test_case_reenter(const doctest::TestCaseData& /*data*/) override { enter(); }

    void report_query(const doctest::QueryData& /*data*/) override {}
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats& /*stats*/) override {}
    void test_case_end(const doctest::CurrentTestCaseStats& /*stats*/) override {}
    void test_case_exception(const doctest::TestCaseException& /*exception*/) override {}
    void subcase_start(const doctest::SubcaseSignature& /*signature*/) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData& /*data*/) override {}
    void log_message(const doctest::MessageData& /*data*/) override {}
    void test_case_skipped(const doctest::TestCaseData& /*data*/) override {}

private:
    static void enter()
    {
        ++entered;
        this_one_is = false;
    }
};

DOCTEST_REGISTER_LISTENER("entries", 1, Entries);

}  // namespace

bool possible(const std::string& missing)
{
    if (missing.empty())
        return true;
    std::printf("skipped: needs %s\n", missing.c_str());
    std::fflush(stdout);  // a case may fork
    if (!this_one_is)
        ++skipped;
    this_one_is = true;
    return false;
}

int run_cases(int argc, char** argv)
{
    const int code = doctest::Context(argc, argv).run();
    return code == 0 && entered > 0 && skipped == entered ? all_skipped : code;
}

}  // namespace hive::test

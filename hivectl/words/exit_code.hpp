// The exit codes of hivectl, and the conversion of errors to exit codes and sentences.
#pragma once

#include <hive/error.hpp>

#include <set>
#include <string>
#include <string_view>

namespace hivectl {

/// The codes that scripts can rely on.
namespace exit_code {
inline constexpr int done = 0;     ///< confirmed by the other end
inline constexpr int failure = 1;  ///< any other failure
inline constexpr int usage = 2;
inline constexpr int not_found = 3;    ///< no such drone, port, parameter
inline constexpr int unreachable = 4;  ///< unreachable or died
inline constexpr int refused = 5;      ///< by the drone; its reason is on stderr
inline constexpr int type_mismatch = 6;
inline constexpr int halted = 7;
inline constexpr int partly_done = 8;
inline constexpr int found = 9;  ///< a verb that looks for faults has found one
inline constexpr int timed_out = 124;
inline constexpr int interrupted = 130;
}  // namespace exit_code

int exit_code_of(hive::Errc code) noexcept;

/// Advice for a drone that is not running: the command that starts it, if there is a program of its kind.
std::string advice_for_missing(const std::string& drone);
/// The error's text and advice, safe to print.
/// @param subject  the drone or port that the error concerns, if known
std::string explained(const hive::Error& error, std::string_view subject = {});

/// From now on, each failure is one line of JSON on stderr, as `hive::failure_in` reads it.
void print_failures_as_json();
bool prints_failures_as_json();
/// Prints the failure and advice on stderr.
/// @param subject  the drone or port that the error concerns, if known
void complain_about(std::string_view verb, const hive::Error& error, std::string_view subject = {});
/// Prints a whole sentence as a failure, without the usual advice. @return the exit code
int fail(std::string_view verb, hive::Errc code, const std::string& sentence, std::string_view subject = {});

/// Collects the results of a request to several drones. Prints failures on stderr as they occur.
class Outcome {
public:
    explicit Outcome(std::string_view verb) : verb_(verb) {}
    void done() { ++done_; }
    void failed(std::string_view subject, const hive::Error& error);
    /// Runs `action`; if it throws, `subject` has failed. @return true if it did not throw
    template <typename Action>
    bool attempt(const std::string& subject, Action&& action)
    try {
        action();
        return true;
    } catch (const hive::Error& error) {
        failed(subject, error);
        return false;
    }
    /// The same for a whole request: otherwise `subject` is done.
    template <typename Action>
    void request(const std::string& subject, Action&& action)
    {
        done_ += attempt(subject, action) ? 1 : 0;
    }
    /// 0 when nothing failed, 8 when only some did, the common code when all failed alike, otherwise 1.
    [[nodiscard]] int exit_code() const;
    /// The exit code of a verb that continued without the failed ones, and ended with `code`.
    [[nodiscard]] int exit_code(int code) const;

private:
    std::string verb_;
    int done_ = 0;
    std::set<int> codes_;
};

/// Prints the reason of a failure with a verb's only subject, and returns the exit code.
int exit_code_of_failure(std::string_view verb, std::string_view subject, const hive::Error& error);

}  // namespace hivectl

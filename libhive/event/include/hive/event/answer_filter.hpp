// Refuses second answers: work that was given out again may be answered twice, once for each attempt.
#pragma once

#include <hive/event.hpp>

#include <deque>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace hive::event {

/// The events that come to one input. The first answer to a piece of work is taken; the same one again, and what
/// another attempt at the work gives, is refused, unless it is of a receiver that has not answered yet and does so for
/// itself. Pure logic, for one thread.
class AnswerFilter {
public:
    static constexpr std::size_t remembered = 65536;
    static constexpr std::size_t remembered_bytes = 16u << 20;  ///< of what names the works and answers

    AnswerFilter();
    /// Is this to be taken? Always true for what nobody gave out as a numbered piece of work. A lossless event that is
    /// refused is acknowledged no sooner than the answer that it repeats, which this process may still lose.
    bool first(const Event& event);

private:
    struct Branch {  ///< who got a share that is behind a group
        std::string receiver;
        bool each = false;  ///< others got it as well, and answer for themselves
        bool operator==(const Branch&) const = default;
    };
    struct Answer {
        std::string work;  ///< with what its key says
        std::string kind;  ///< of the drone that answers, where that tells works apart
        std::string path;  ///< the drones that got the shares
        std::string attempts;
        std::vector<Branch> branches;
        std::string each;     ///< for each part of the work, '1': others got it as well
        bool failed = false;  ///< an exception: there will be no result
        std::weak_ptr<Acknowledgement> owed;
    };
    static std::pair<std::string, Answer> named(const Event& event, std::size_t count);
    static bool stand_for_each_other(const Answer& one, const Answer& other);
    static bool includes(const Answer& whole, const Answer& part);
    void remember(std::string key, Answer answer);

    void forget_oldest();
    static std::size_t size_of(const std::string& key, const Answer& answer);

    using Answers = std::unordered_map<std::string, std::vector<Answer>>;
    bool off_;                            ///< by a test that shows what it is for
    Answers answers_;                     ///< that were taken, by the beginning and the end of their work
    std::deque<Answers::pointer> order_;  ///< one for each answer
    std::size_t bytes_ = 0;               ///< of all answers, with their works
};

/// The shares that others stand behind: all but the one by which the sender itself gave the event to this input, since
/// that one may rightly come again.
std::size_t shares_behind(const Event& event);

}  // namespace hive::event

// Rejects duplicates: an event that came again, and the results of work that was dispatched again.
#pragma once

#include <hive/event.hpp>
#include <hive/event/taken_turns.hpp>

#include <deque>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace hive::event {

/// Filters the events of one input. An event of the source is accepted once. Of the answers to a piece of work the
/// first one is accepted; its repetition, and the result of another attempt, is rejected, unless it comes from a
/// receiver that answers for itself and has not answered yet. Pure logic, for one thread.
class AnswerFilter {
public:
    static constexpr std::size_t remembered = 65536;
    static constexpr std::size_t remembered_bytes = 16u << 20;  ///< of the keys of works and answers

    AnswerFilter();
    /// Is this event to be accepted? Always true if it has no shares. A rejected lossless event is acknowledged no
    /// sooner than the one that it repeats, which this process may still lose.
    bool first(const Event& event);

private:
    struct Branch {  ///< the receiver of a share that is behind a group
        std::string receiver;
        bool each = false;  ///< other receivers got it as well, and answer for themselves
        bool operator==(const Branch&) const = default;
    };
    struct Answer {
        std::string work;      ///< with what its key says
        std::string kind;      ///< of the answering drone, if that distinguishes works
        std::string answerer;  ///< `#GROUP` or the drone, if the kind distinguishes works
        std::string path;      ///< the drones that got the shares
        std::string attempts;
        std::vector<Branch> branches;
        std::string each;     ///< for each part of the work, '1': other receivers got it as well
        bool failed = false;  ///< an exception: there will be no result
        std::weak_ptr<Acknowledgement> owed;
    };
    static std::pair<std::string, Answer> named(const Event& event, std::size_t count);
    static bool stand_for_each_other(const Answer& one, const Answer& other);
    static bool includes(const Answer& whole, const Answer& part);
    void remember(std::string key, Answer answer);

    TakenTurns& turns_of(const Share& share);
    void forget_oldest();
    static std::size_t size_of(const std::string& key, const Answer& answer);

    using Answers = std::unordered_map<std::string, std::vector<Answer>>;
    std::deque<TakenTurns> turns_;        ///< of events that are no answers
    bool off_;                            ///< by a test that shows its purpose
    Answers answers_;                     ///< accepted ones, by the beginning and the end of their work
    std::deque<Answers::pointer> order_;  ///< one for each answer
    std::size_t bytes_ = 0;               ///< of all answers, with their works
};

/// The shares of other senders: all except the share by which the sender itself dispatched the event to this input,
/// since that one may be repeated.
std::size_t shares_behind(const Event& event);

}  // namespace hive::event

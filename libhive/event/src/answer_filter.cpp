// Remembers, within bounds, which attempt answered.
#include <hive/event/answer_filter.hpp>
#include <hive/event/ticket.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <span>

namespace hive::event {
namespace {

constexpr std::string_view exceptions = "exceptions";
constexpr char part_begins = ' ';  // separates the shares in a work's key

/// The drone and the input that got a share, `DRONE.INPUT`. A sender that gave up names them itself.
std::pair<std::string, std::string> receiver_of(const Event& event, std::size_t i)
{
    const auto& shares = event.identity.shares;
    const Share& share = shares[i];
    const bool given_up = event.output == exceptions && share.sender() == event.sender;
    if (const auto dot = share.to.rfind('.'); given_up && dot != std::string::npos)
        return {share.to.substr(0, dot), share.to.substr(dot + 1)};
    return {i + 1 < shares.size() ? std::string(shares[i + 1].sender()) : event.sender, share.to};
}

/// Adds a stage of the pipeline to the key. Members of a group are interchangeable, so behind a group the key names
/// neither drones nor their groups. Workers of the first group may have inputs of different names.
void add_stage(std::string& work, const Share& share, const std::string& receiver, const std::string& input,
               bool behind_group)
{
    work += part_begins;
    work += behind_group ? share.output().substr(share.sender().size()) : share.of;
    ((work += '/') += std::to_string(share.part)) += '>';
    if (!behind_group && !share.group())
        (work += receiver) += '.';  // each plain receiver gives its own answer
    if (behind_group || !share.group())
        work += input;
}

std::size_t parts_of(const std::string& work)
{
    return static_cast<std::size_t>(std::ranges::count(work, part_begins));
}

}  // namespace

std::size_t shares_behind(const Event& event)
{
    const auto& shares = event.identity.shares;
    if (shares.empty())
        return 0;
    const bool own = shares.back().output() == event.sender + "." + event.output;
    return shares.size() - (own ? 1 : 0);
}

AnswerFilter::AnswerFilter() : off_(!defended("answer-filter")) {}

bool AnswerFilter::first(const Event& event)
{
    if (event.identity.shares.empty() || off_)
        return true;
    const auto count = shares_behind(event);
    if (count == 0)
        return turns_of(event.identity.shares.back()).take(event);
    auto found = named(event, count);
    auto& key = found.first;
    auto& answer = found.second;
    const auto known = answers_.find(key);
    const auto taken = known == answers_.end() ? std::span<const Answer>() : std::span<const Answer>(known->second);
    const auto before =
        std::ranges::find_if(taken, [&](const Answer& one) { return stand_for_each_other(one, answer); });
    if (before == taken.end()) {
        remember(std::move(key), std::move(answer));
        return true;
    }
    if (const auto owed = before->owed.lock(); owed && event.identity.lossless)
        owed->hold(event.ticket.owed());
    return false;
}

TakenTurns& AnswerFilter::turns_of(const Share& share)
{
    constexpr std::size_t most = 64;
    const auto found = std::ranges::find_if(turns_, [&](const TakenTurns& turns) { return turns.counts(share); });
    if (found != turns_.end())
        return *found;
    if (turns_.size() == most)
        turns_.pop_front();
    return turns_.emplace_back(share);
}

/// The key of the work that the event answers, and the answer.
std::pair<std::string, AnswerFilter::Answer> AnswerFilter::named(const Event& event, std::size_t count)
{
    const auto& shares = event.identity.shares;
    std::string key = std::to_string(shares[0].epoch) + ":" + std::to_string(shares[0].turn);
    Answer answer{.work = {},
                  .kind = {},
                  .answerer = {},
                  .path = {},
                  .attempts = {},
                  .branches = {},
                  .each = {},
                  .failed = event.output == exceptions,
                  .owed = event.ticket.owed()};
    bool behind_group = false, by_kind = false;
    for (std::size_t i = 0; i < count; ++i) {
        const Share& share = shares[i];
        const auto [receiver, input] = receiver_of(event, i);
        add_stage(i == 0 ? key : answer.work, share, receiver, input, behind_group);
        if (i > 0) {  // the first is in the key
            (((answer.path += ' ') += share.output()) += '/') += std::to_string(share.part);
            answer.each += share.each ? '1' : '0';
        }
        (((answer.path += '>') += receiver) += '.') += input;
        (answer.attempts += std::to_string(share.attempt)) += ' ';
        if (behind_group)
            answer.branches.push_back(share.group() ? Branch() : Branch{receiver, share.each});
        by_kind = behind_group;
        behind_group = behind_group || share.group();
    }
    if (by_kind) {  // several plain receivers, or groups, may do different work behind this group
        const Share& last = shares[count - 1];
        answer.kind = event.kind;
        answer.answerer = last.group() ? last.of.substr(last.of.find('#')) : receiver_of(event, count - 1).first;
    }
    (((key += " .") += event.output) += '/') += std::to_string(event.identity.part);
    return {std::move(key), std::move(answer)};
}

/// Does either of two answers make the other redundant? No if a drone sent its result to several receivers, and the
/// answers come from different ones. Each attempt went to one drone, which gives each answer once. Answers over the
/// same path are the same, even if a receiver on the path shared the work one time and not the other. So are those of a
/// drone that was replaced by one of another kind, and those of members of one group, whatever their kinds. An
/// exception covers all results of its work; a later exception that covers more is new if several drones got the next
/// share.
bool AnswerFilter::stand_for_each_other(const Answer& one, const Answer& other)
{
    if (one.path == other.path || includes(one, other)
        || (includes(other, one) && one.each[parts_of(other.work)] == '0'))
        return true;
    if (one.work != other.work || (one.kind != other.kind && one.answerer != other.answerer))
        return false;
    if (one.attempts == other.attempts)
        return one.branches == other.branches;
    const auto [mine, its] =
        std::ranges::mismatch(one.branches, other.branches, {}, &Branch::receiver, &Branch::receiver);
    return mine == one.branches.end() || its == other.branches.end() || !(mine->each || its->each);
}

/// Is `part` a part of the work that `whole` gave up?
bool AnswerFilter::includes(const Answer& whole, const Answer& part)
{
    return whole.failed && part.work.size() > whole.work.size() && part.work.starts_with(whole.work)
           && part.work[whole.work.size()] == part_begins;
}

void AnswerFilter::remember(std::string key, Answer answer)
{
    bytes_ += size_of(key, answer);
    auto& row = *answers_.try_emplace(std::move(key)).first;
    row.second.push_back(std::move(answer));
    order_.push_back(&row);
    while (order_.size() > remembered || bytes_ > remembered_bytes)
        forget_oldest();
}

void AnswerFilter::forget_oldest()
{
    auto& [key, answers] = *order_.front();
    order_.pop_front();
    bytes_ -= size_of(key, answers.front());
    answers.erase(answers.begin());
    if (answers.empty())
        answers_.erase(answers_.find(key));
}

std::size_t AnswerFilter::size_of(const std::string& key, const Answer& answer)
{
    auto bytes = key.size() + answer.work.size() + answer.kind.size() + answer.answerer.size() + answer.path.size()
                 + answer.attempts.size() + answer.each.size() + answer.branches.size() * sizeof(Branch);
    for (const auto& branch : answer.branches)
        bytes += branch.receiver.size();
    return bytes;
}

}  // namespace hive::event

// A bounded memory of which attempt answered.
#include <hive/event/answer_filter.hpp>
#include <hive/event/ticket.hpp>
#include <hive/protocol/defended.hpp>

#include <algorithm>
#include <span>

namespace hive::event {
namespace {

std::string without_group(const Share& share) { return share.of.substr(0, share.of.find('#')); }

std::string drone_of(const Share& share) { return share.of.substr(0, without_group(share).rfind('.')); }

/// Which part of a pipeline that is. Members of a group are interchangeable, so behind a group neither drones nor their
/// groups have names. Workers of the first group may call their inputs as they like.
void add_stage(std::string& work, const Share& share, const std::string& receiver, bool behind_group)
{
    const auto sharp = share.of.find('#'), dot = share.of.substr(0, sharp).rfind('.');
    work += ' ';
    work += behind_group ? share.of.substr(dot, sharp - dot) : share.of;
    ((work += '/') += std::to_string(share.part)) += '>';
    if (!behind_group && !share.group())
        (work += receiver) += '.';  // each plain receiver gives an answer of its own
    if (behind_group || !share.group())
        work += share.to;
}

}  // namespace

std::size_t shares_behind(const Event& event)
{
    const auto& shares = event.identity.shares;
    if (shares.empty())
        return 0;
    const std::string_view last = shares.back().of;
    const bool own = last.substr(0, last.find('#')) == event.sender + "." + event.output;
    return shares.size() - (own ? 1 : 0);
}

AnswerFilter::AnswerFilter() : off_(!defended("answer-filter")) {}

bool AnswerFilter::first(const Event& event)
{
    const auto count = shares_behind(event);
    if (count == 0 || off_)
        return true;
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

/// A key of the work that the event answers, and which answer that is.
std::pair<std::string, AnswerFilter::Answer> AnswerFilter::named(const Event& event, std::size_t count)
{
    const auto& shares = event.identity.shares;
    std::string key = std::to_string(shares[0].epoch) + ":" + std::to_string(shares[0].turn);
    Answer answer{.work = {}, .path = {}, .attempts = {}, .branches = {}, .owed = event.ticket.owed()};
    bool behind_group = false, by_kind = false;
    for (std::size_t i = 0; i < count; ++i) {
        const Share& share = shares[i];
        const auto receiver = i + 1 < shares.size() ? drone_of(shares[i + 1]) : event.sender;
        add_stage(i == 0 ? key : answer.work, share, receiver, behind_group);
        if (i > 0)  // the key has the first
            (((answer.path += ' ') += without_group(share)) += '/') += std::to_string(share.part);
        (((answer.path += '>') += receiver) += '.') += share.to;
        (answer.attempts += std::to_string(share.attempt)) += ' ';
        if (behind_group)
            answer.branches.push_back(share.group() ? Branch() : Branch{receiver, share.each});
        by_kind = behind_group;
        behind_group = behind_group || share.group();
    }
    if (by_kind)  // the group that this names may have workers of several kinds
        (answer.work += ' ') += event.kind;
    (((key += " .") += event.output) += '/') += std::to_string(event.identity.part);
    return {std::move(key), std::move(answer)};
}

/// Does either of two answers make the other superfluous? Not where a drone gave what it made of the work to several
/// others, and these two are of different ones. An attempt was given to one drone, which gives each answer once. What
/// went the same way is the same, also if a receiver on the way shared it once and was alone the other time.
bool AnswerFilter::stand_for_each_other(const Answer& one, const Answer& other)
{
    if (one.path == other.path)
        return true;
    if (one.work != other.work)
        return false;
    if (one.attempts == other.attempts)
        return one.branches == other.branches;
    const auto [mine, its] =
        std::ranges::mismatch(one.branches, other.branches, {}, &Branch::receiver, &Branch::receiver);
    return mine == one.branches.end() || its == other.branches.end() || !(mine->each || its->each);
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
    auto bytes = key.size() + answer.work.size() + answer.path.size() + answer.attempts.size()
                 + answer.branches.size() * sizeof(Branch);
    for (const auto& branch : answer.branches)
        bytes += branch.receiver.size();
    return bytes;
}

}  // namespace hive::event

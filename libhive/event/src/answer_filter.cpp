// A bounded memory of which attempt answered.
#include <hive/event/answer_filter.hpp>
#include <hive/event/receipt.hpp>

#include <algorithm>
#include <cstdlib>

namespace hive::event {
namespace {

std::string drone_of(const Share& share)
{
    return share.of.substr(0, share.of.substr(0, share.of.find('#')).rfind('.'));
}

/// Which part of a pipeline that is. Members of a group are interchangeable, so behind a group drones have no names,
/// but where one of them gives each event to several others.
void add_stage(std::string& work, const Share& share, const std::string& receiver, bool behind_group)
{
    const auto sharp = share.of.find('#'), dot = share.of.substr(0, sharp).rfind('.');
    work += ' ';
    work += behind_group ? share.of.substr(dot, sharp - dot) : share.of;  // nor have their groups
    ((work += '/') += std::to_string(share.part)) += '>';
    if ((!behind_group || share.each) && !share.group())
        (work += receiver) += '.';  // each plain receiver gives an answer of its own
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

bool given_by_group(const Event& event)
{
    return shares_behind(event) < event.identity.shares.size() && event.identity.shares.back().group();
}

AnswerFilter::AnswerFilter() : off_(std::getenv("HIVE_TEST_NO_ANSWER_FILTER") != nullptr) {}

bool AnswerFilter::first(const Event& event)
{
    const auto count = shares_behind(event);
    if (count == 0 || off_)
        return true;
    const auto& shares = event.identity.shares;
    std::string work = std::to_string(shares[0].epoch) + ":" + std::to_string(shares[0].turn), attempts;
    bool behind_group = false, by_kind = true;
    for (std::size_t i = 0; i < count; ++i) {
        add_stage(work, shares[i], i + 1 < shares.size() ? drone_of(shares[i + 1]) : event.sender, behind_group);
        by_kind = behind_group || !shares[i].group();
        behind_group = behind_group || shares[i].group();
        (attempts += std::to_string(shares[i].attempt)) += ' ';
    }
    work += ' ';
    if (by_kind)  // the group that this key names may have workers of several kinds
        work += event.kind;
    (work += '.') += event.output;
    (work += '/') += std::to_string(event.identity.part);
    const auto [place, inserted] = answers_.try_emplace(work, Answer{attempts, event.custody});
    if (!inserted) {
        const bool same = place->second.attempts == attempts;
        if (const auto custody = place->second.custody.lock(); custody && event.identity.lossless && !same)
            static_cast<const Custody*>(custody.get())->hold(event.custody);
        return same;
    }
    order_.push_back(std::move(work));
    if (order_.size() > remembered) {
        answers_.erase(order_.front());
        order_.pop_front();
    }
    return true;
}

}  // namespace hive::event

// The states of a set, and the answers at each change.
#include "proposal.hpp"

#include <utility>

namespace hive::service {

void Proposal::prepare(const Json& result)
{
    if (state_ != State::waiting)
        return;
    state_ = State::prepared;
    answer(result);
}

void Proposal::commit(std::optional<Answer> answer)
{
    state_ = State::committed;
    if (answer)
        terms_.answer = std::move(*answer);
}

void Proposal::confirm(const Json& result) { answer(result); }

void Proposal::give_up(const Error& reason)
{
    if (!undecided())
        return;
    state_ = State::given_up;
    answer(reason);
}

void Proposal::answer(const event::Outcome& outcome)
{
    if (const auto waiting = std::exchange(terms_.answer, {}))
        waiting(outcome);
}

}  // namespace hive::service

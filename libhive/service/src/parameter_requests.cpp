// Reads parameters at once; tries sets between two callbacks, and answers them by their deadline.
#include "parameter_requests.hpp"

#include <hive/protocol/requests.hpp>

#include <algorithm>

namespace hive::service {

using event::Clock;
using event::Incoming;

namespace {

using std::chrono::milliseconds;

constexpr milliseconds max_set_timeout = std::chrono::hours(24);  ///< the maximum deadline of a `set`
/// If this process was suspended until a prepared set expired, a commit that arrived in time is read now.
constexpr milliseconds last_look(200);

/// The answer when the drone's code threw: the set was understood and refused.
Error refusal(const Error& error)
{
    return {error.code() == Errc::failed ? Errc::refused : error.code(), error.what()};
}

}  // namespace

void ParameterRequests::on_get(const Incoming& incoming) const
{
    const auto [names, asked] = protocol::get_from_json(incoming.header);
    auto values = asked ? parts_.parameters.asked(names) : parts_.parameters.values(names);
    if (incoming.role == Role::viewer)
        for (const auto& parameter : parts_.parameters.declared())
            if (parameter.for_operator && values.erase(parameter.name) > 0 && !names.empty())
                throw Error(Errc::not_permitted, parameter.name + " concerns the drone's machine: hidden from viewers");
    incoming.answer(Json{{"parameters", std::move(values)}});
}

/// Parameters that affect the drone's machine are for peers on that machine.
void ParameterRequests::require_allowed(const Incoming& incoming, const Json& wanted) const
{
    if (incoming.role == Role::owner || parts_.remote_operator)
        return;
    for (const auto& parameter : parts_.parameters.declared())
        if (parameter.for_operator && wanted.contains(parameter.name))
            throw Error(Errc::not_permitted,
                        parameter.name + " concerns the machine of " + parts_.module.self().name
                            + ", so it is not set over the network",
                        "set it on that machine, or start the drone there with --remote-operator");
}

void ParameterRequests::on_set(const Incoming& incoming)
{
    const auto set = protocol::set_from_json(incoming.header);
    incoming.asked->begin();  // from here on the code below enforces the deadline
    if (set.commit)
        return on_commit(incoming, *set.commit);
    if (set.abort)
        return on_abort(incoming, *set.abort);
    require_allowed(incoming, set.parameters);
    const auto longest = set.prepare ? milliseconds(protocol::Set::max_prepare_ms) : max_set_timeout;
    Proposal::Terms terms{.values = parts_.parameters.checked(set.parameters),
                          .deadline = std::min(incoming.asked->deadline(), Clock::now() + longest),
                          .token = set.prepare,
                          .asker = incoming.peer,
                          .connection = incoming.connection,
                          .connected = incoming.connected,
                          .answer = incoming.answer};
    if (set.check_only)
        return incoming.answer(Json{{"parameters", terms.values}, {"previous", present_values(terms.values)}});
    propose(std::move(terms));
}

void ParameterRequests::propose(Proposal::Terms terms)
{
    if (terms.token)
        require_free(terms.asker);
    const auto proposal = std::make_shared<Proposal>(std::move(terms));
    if (proposal->by_asker())
        held_ = proposal;
    under_way_.try_emplace(proposal, parts_.module.context())
        .first->second.run_at(proposal->deadline(),
                              [this, weak = std::weak_ptr(proposal)] { on_deadline(weak.lock()); });
    parts_.mailbox.push([this, proposal] { carry_out(parts_.worker, proposal); });
}

/// Refuses a second prepare at once instead of queueing it: two sets that wait for each other on two drones would wait
/// for their deadlines. The first refused asker has the next turn, or else the most frequent one would have them all.
void ParameterRequests::require_free(const std::string& asker)
{
    if (held_ && !held_->wanted() && !held_->committed())
        give_up(held_, Error(Errc::connection_lost, "the application is gone"));
    if (held_) {
        turns_.refused(asker);
        throw Error(Errc::locked, parts_.module.self().name + " is being set by " + held_->asker());
    }
    if (const auto owner = turns_.taken_by(asker, Clock::now()); !owner.empty())
        throw Error(Errc::locked, parts_.module.self().name + " is to be set by " + owner + " next");
}

ProposalPtr ParameterRequests::held(const Incoming& incoming, std::int64_t token) const
{
    if (held_ && held_->has(token, incoming.connection) && held_->undecided())
        return held_;
    throw Error(Errc::not_found,
                parts_.module.self().name
                    + " has no pending set with this token: aborted or expired; the old values are kept");
}

void ParameterRequests::on_commit(const Incoming& incoming, std::int64_t token)
{
    const auto proposal = held(incoming, token);
    if (!proposal->prepared())
        throw Error(Errc::refused, parts_.module.self().name + " has not prepared this set yet");
    proposal->commit(incoming.answer);
}

void ParameterRequests::on_abort(const Incoming& incoming, std::int64_t token)
{
    give_up(held(incoming, token), Error(Errc::refused, "aborted by " + incoming.peer));
    incoming.answer(Json::object());
}

void ParameterRequests::give_up(const ProposalPtr& proposal, const Error& reason)
{
    proposal->give_up(reason);
    forget(proposal);
}

void ParameterRequests::forget(const ProposalPtr& proposal)
{
    if (held_ == proposal) {
        held_.reset();
        turns_.freed(proposal->committed(), Clock::now());
    }
    under_way_.erase(proposal);
}

/// A prepared set is held for longer, because its asker may have decided already: see hold().
void ParameterRequests::on_deadline(const ProposalPtr& proposal)
{
    if (proposal && proposal->undecided() && !proposal->prepared())
        give_up(proposal, too_late());
}

Error ParameterRequests::too_late() const
{
    return {Errc::timeout, parts_.module.self().name + " was busy past the deadline; nothing was set"};
}

void ParameterRequests::end()
{
    for (const auto& [proposal, deadline] : std::exchange(under_way_, {}))
        proposal->give_up(Error(Errc::stopped, parts_.module.self().name + " is ending; nothing was set"));
    held_.reset();
}

void ParameterRequests::carry_out(Worker& worker, const ProposalPtr& proposal)
{
    bool wanted = false;
    parts_.module.call([&] { wanted = begin(proposal); });
    if (!wanted)
        return;
    if (const auto problem = worker.try_out(proposal->values()))
        return parts_.module.call([&] { give_up(proposal, refusal(*problem)); });
    if (proposal->by_asker()) {
        parts_.board.prepared(true);
        hold(worker, *proposal);
        parts_.board.prepared(false);
    }
    bool kept = false;
    parts_.module.call([&] { kept = settle(worker, proposal); });
    if (!kept)
        worker.put_back();
}

bool ParameterRequests::begin(const ProposalPtr& proposal)
{
    if (Clock::now() >= proposal->deadline())
        give_up(proposal, too_late());
    else if (!proposal->wanted())
        give_up(proposal, Error(Errc::connection_lost, "the application is gone"));
    return proposal->undecided();
}

/// No callback may see undecided values, so the user thread waits here and runs the network side: until the decision,
/// the end of the asker's connection or of the drone, and at most until the end of the grace period. A drone that hands
/// over waits as for a running callback: other drones may have committed already, and its successor reads the state
/// file after the decision.
void ParameterRequests::hold(const Worker& worker, Proposal& proposal)
{
    parts_.module.call([&] {
        proposal.prepare(
            {{"parameters", worker.tried(proposal.values())}, {"previous", present_values(proposal.values())}});
    });
    const auto until = proposal.deadline() + Proposal::grace;
    auto& loop = parts_.module.loop();
    const auto& board = parts_.board;
    const auto over = [&] { return !proposal.wanted() || (board.stopping() && !board.handing_over()); };
    loop.wait(until, over);
    if (Clock::now() >= until)
        loop.wait(Clock::now() + last_look, over);
}

/// The values are in the state file before the set is confirmed.
bool ParameterRequests::settle(Worker& worker, const ProposalPtr& proposal)
{
    if (!proposal->by_asker() && Clock::now() < proposal->deadline() && proposal->undecided())
        proposal->commit();
    if (!proposal->committed()) {
        if (proposal->prepared())
            parts_.module.log_about(LogLevel::warning, proposal->asker(),
                                    "aborted a set that " + proposal->asker()
                                        + " prepared and did not decide; the old values are kept");
        give_up(proposal, too_late());
        return false;
    }
    const Json before = present_values(proposal->values());
    worker.keep(proposal->values());
    parts_.state_file.remember();
    proposal->confirm({{"parameters", present_values(proposal->values())}, {"previous", before}});
    forget(proposal);
    return true;
}

Json ParameterRequests::present_values(const Json& wanted) const
{
    Json values = Json::object();
    for (const auto& [name, value] : wanted.items())
        values.update(parts_.parameters.values({name}));
    return values;
}

}  // namespace hive::service

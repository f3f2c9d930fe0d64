// Queues of events, one per receiver that waits for an encoding.
#include <hive/event/dispatch.hpp>

namespace hive::event {
namespace {

/// The event as returned by the encoder, checked like an emitted one.
EmissionPtr encoded(const Encoder& encoder, const Emission& emission, const std::string& encoding)
{
    Event result = encoder.encode(emission.event(), encoding);
    result.ticket = {};
    result.size = result.body.size();
    require_at_most("a body", result.size, protocol::Limits{}.body);
    return std::make_shared<const Emission>(std::move(result), true, emission.own());
}

}  // namespace

void Dispatch::send(const Send& send, const std::string& encoding)
{
    const auto form = encoding.empty() ? send.event : send.event->rendition(encoding);
    if (form && !lines_.contains(send.receiver))
        return hooks_.transmit(send, *form);
    const auto waiting = std::make_shared<Waiting>(Waiting{send, form});
    lines_[send.receiver].push_back(waiting);
    if (!form)
        encode(waiting, encoding);
}

void Dispatch::end(ReceiverId receiver)
{
    const auto line = lines_.find(receiver);
    if (line == lines_.end())
        return hooks_.end(receiver);
    line->second.push_back(std::make_shared<Waiting>(Waiting{{receiver, nullptr, {}, {}}, nullptr}));
}

void Dispatch::encode(const std::shared_ptr<Waiting>& waiting, const std::string& encoding)
{
    const auto job = [this, alive = std::weak_ptr(alive_), weak = std::weak_ptr(waiting), encoding] {
        const auto wanted = weak.lock();
        if (!wanted)
            return;
        const EmissionPtr event = wanted->send.event;
        hooks_.on_network_side([this, alive, weak, event, result = make(event, encoding)] {
            if (!alive.expired())
                made(weak, event, result);
        });
    };
    hooks_.on_encoder_thread(waiting->send.receiver, job);
}

/// On the encoder thread.
Dispatch::Made Dispatch::make(const EmissionPtr& event, const std::string& encoding) const
{
    Made result{event->rendition(encoding), {}};
    if (result.form)
        return result;
    try {
        result.form = encoded(encoder_, *event, encoding);
    } catch (...) {
        const Error error = current_error();
        result.problem = Error(error.code(), encoding + ": " + error.what());
    }
    if (result.problem) {  // a copy, since an event that holds itself would never be freed
        Event as_it_is = event->event();
        as_it_is.ticket = {};
        result.form = std::make_shared<const Emission>(std::move(as_it_is), true, event->own());
    }
    event->keep_rendition(encoding, result.form);
    return result;
}

void Dispatch::made(const std::weak_ptr<Waiting>& weak, const EmissionPtr& event, const Made& result)
{
    if (result.problem)
        hooks_.not_encoded(event, *result.problem);
    const auto waiting = weak.lock();
    if (!waiting)
        return;
    waiting->form = result.form;
    advance(waiting->send.receiver);
}

void Dispatch::advance(ReceiverId receiver)
{
    const auto line = lines_.find(receiver);
    if (line == lines_.end())
        return;
    while (!line->second.empty() && line->second.front()->ready()) {
        const auto first = line->second.front();
        line->second.pop_front();
        if (first->form)
            hooks_.transmit(first->send, *first->form);
        else
            hooks_.end(receiver);
    }
    if (line->second.empty())
        lines_.erase(line);
}

}  // namespace hive::event

// The functions of events, bodies and loans.
#include "event.hpp"

#include "library_thread.hpp"
#include "texts.hpp"

namespace hive::c {
namespace {

Json share_json(const Share& share)
{
    return {{"of", share.of},           {"epoch", share.epoch}, {"turn", share.turn},
            {"attempt", share.attempt}, {"part", share.part},   {"to", share.to}};
}

Json info_of(const Event& event)
{
    const Identity& identity = event.identity;
    Json shares = Json::array(), hops = Json::array();
    for (const auto& share : identity.shares)
        shares.push_back(share_json(share));
    for (const auto& hop : identity.hops)
        hops.push_back({{"drone", hop.drone}, {"wait_us", hop.wait_us}, {"work_us", hop.work_us}});
    return {{"source", identity.source},
            {"epoch", identity.epoch},
            {"sequence", identity.sequence},
            {"captured_us", identity.captured_us},
            {"monotonic_us", identity.monotonic_us},
            {"lossless", identity.lossless},
            {"part", identity.part},
            {"sender", event.sender},
            {"kind", event.kind},
            {"output", event.output},
            {"input", event.input},
            {"type", event.type},
            {"size", event.sized ? Json(event.size) : Json()},
            {"age_us", event.age().count()},
            {"shares", std::move(shares)},
            {"hops", std::move(hops)}};
}

}  // namespace

Event EventObject::copy() const
{
    const std::lock_guard lock(mutex_);
    Event copy = event_;
    copy.ticket = {};
    return copy;
}

const std::string& EventObject::header() const
{
    const std::lock_guard lock(mutex_);
    if (!header_)
        header_ = to_text(event_.header);
    return *header_;
}

/// Releases the content without the lock: releasing a ticket may be slow.
void EventObject::done()
{
    Ticket ticket;
    const std::lock_guard lock(mutex_);
    ticket = std::move(event_.ticket);
}

std::span<std::byte> LoanObject::bytes() const
{
    const std::lock_guard lock(mutex_);
    if (!loan_)
        throw Error(Errc::invalid_argument, "this loan was already used");
    return {reinterpret_cast<std::byte*>(loan_->data()), loan_->size()};
}

Body LoanObject::body(std::size_t size)
{
    const auto whole = bytes();
    if (size > whole.size())
        throw Error(Errc::invalid_argument,
                    "the loan has " + std::to_string(whole.size()) + " bytes, not " + std::to_string(size));
    const std::lock_guard lock(mutex_);
    if (!loan_)
        throw Error(Errc::invalid_argument, "this loan was already used");
    Body body = std::move(*loan_).body(size);
    loan_.reset();
    return body;
}

Lent::Lent(const std::vector<Event>& events)
{
    handles_.reserve(events.size());
    for (const auto& event : events)
        handles_.push_back(give(std::make_shared<EventObject>(event)));
}

Lent::Lent(const Event& event) : handles_{give(std::make_shared<EventObject>(event))} {}

Lent::~Lent()
{
    for (const auto* handle : handles_)
        hive_release(handle);
}

}  // namespace hive::c

using namespace hive;
using namespace hive::c;

namespace {

std::int64_t number_of(const Event& event, std::string_view field)
{
    const auto& identity = event.identity;
    for (const auto& [name, value] : {std::pair<std::string_view, std::int64_t>{"epoch", identity.epoch},
                                      {"sequence", identity.sequence},
                                      {"captured_us", identity.captured_us},
                                      {"monotonic_us", identity.monotonic_us},
                                      {"part", identity.part},
                                      {"size", static_cast<std::int64_t>(event.size)},
                                      {"age_us", event.age().count()}})
        if (name == field)
            return value;
    throw Error(Errc::invalid_argument, "an event has no number " + in_quotes(field));
}

template <class Bytes>
void give_bytes(const Bytes& from, const void** bytes, size_t* size)
{
    *required(bytes, "the place for the bytes") = from.data();
    *required(size, "the place for their size") = from.size();
}

}  // namespace

hive_code hive_event_info(const hive_event* event, char** json, size_t* length)
{
    return guarded([&] { give_json(info_of(get<EventObject>(event)->event()), json, length); });
}

hive_code hive_event_number(const hive_event* event, const char* field, int64_t* value)
{
    return guarded([&] {
        required(value, "the place for the value");
        *value = number_of(get<EventObject>(event)->event(), text_of(field, "the field"));
    });
}

hive_code hive_event_hop(const hive_event* event, size_t index, const char** drone, int64_t* wait_us, int64_t* work_us)
{
    return guarded([&] {
        const auto object = get<EventObject>(event);
        const auto& hops = object->event().identity.hops;
        if (index >= hops.size())
            throw Error(Errc::not_found, "the event has passed " + std::to_string(hops.size()) + " drones");
        *required(drone, "the place for the drone") = hops[index].drone.c_str();
        *required(wait_us, "the place for the time of waiting") = hops[index].wait_us;
        *required(work_us, "the place for the time of work") = hops[index].work_us;
    });
}

hive_code hive_event_header(const hive_event* event, const char** json, size_t* length)
{
    return guarded([&] {
        const auto object = get<EventObject>(event);
        const auto& text = object->header();
        *required(json, "the place for the header") = text.c_str();
        if (length)
            *length = text.size();
    });
}

hive_code hive_event_bytes(const hive_event* event, const void** bytes, size_t* size)
{
    return guarded([&] { give_bytes(get<EventObject>(event)->event().body.bytes(), bytes, size); });
}

hive_code hive_event_body(const hive_event* event, hive_body** body)
{
    return guarded([&] {
        required(body, "the place for the body");
        *body = give(std::make_shared<BodyObject>(get<EventObject>(event)->event().body));
    });
}

hive_code hive_event_done(hive_event* event)
{
    return guarded([&] { get<EventObject>(event)->done(); });
}

hive_code hive_body_new(const void* bytes, size_t size, hive_body** body)
{
    return guarded([&] {
        required(body, "the place for the body");
        const auto* first = static_cast<const unsigned char*>(size > 0 ? required(bytes, "the bytes") : bytes);
        *body = give(std::make_shared<BodyObject>(Body(std::vector<unsigned char>(first, first + size))));
    });
}

hive_code hive_body_over(const void* bytes, size_t size, void (*free_bytes)(void* user), void* user, hive_body** body)
{
    return guarded([&] {
        required(body, "the place for the body");
        required(free_bytes, "free_bytes");
        const auto* first = static_cast<const std::byte*>(required(bytes, "the bytes"));
        // Armed only once nothing can fail any more: on failure the caller keeps the memory.
        const auto armed = std::make_shared<bool>(false);
        const std::shared_ptr<const void> owner(bytes, [=](const void*) {
            const LibraryThread here;
            if (*armed)
                free_bytes(user);
        });
        *body = give(std::make_shared<BodyObject>(Body(std::span(first, size), owner)));
        *armed = true;
    });
}

hive_code hive_body_bytes(const hive_body* body, const void** bytes, size_t* size)
{
    return guarded([&] { give_bytes(get<BodyObject>(body)->body.bytes(), bytes, size); });
}

hive_code hive_body_foreign(const hive_body* body, bool* foreign)
{
    return guarded([&] { *required(foreign, "the place for the answer") = get<BodyObject>(body)->body.foreign(); });
}

hive_code hive_loan_bytes(const hive_loan* loan, void** bytes, size_t* size)
{
    return guarded([&] {
        const auto span = get<LoanObject>(loan)->bytes();
        *required(bytes, "the place for the bytes") = span.data();
        *required(size, "the place for their size") = span.size();
    });
}

hive_code hive_loan_body(hive_loan* loan, size_t size, hive_body** body)
{
    return guarded([&] {
        required(body, "the place for the body");
        const auto object = get<LoanObject>(loan);
        *body = give(std::make_shared<BodyObject>(object->body(size)));
    });
}

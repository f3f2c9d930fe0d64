// The messages about bodies in shared memory: segments, references and releases (SPEC.md, section 11).
#include "little_endian.hpp"

#include <hive/protocol/messages.hpp>

namespace hive::protocol {
namespace {

constexpr std::size_t slot_bytes = 16;
constexpr std::size_t reference_bytes = slot_bytes + 16;

void put_slot(unsigned char* at, const Slot& slot)
{
    store(at, slot.segment);
    store(at + 4, slot.index);
    store(at + 8, slot.generation);
}

Slot get_slot(const unsigned char* at)
{
    return {load<std::uint32_t>(at), load<std::uint32_t>(at + 4), load<std::uint64_t>(at + 8)};
}

}  // namespace

Json to_json(const Segment& segment)
{
    return {{"segment", segment.id}, {"slots", segment.slots}, {"slot_size", segment.slot_size}};
}

Segment segment_from_json(const Json& object)
{
    constexpr std::int64_t most = 0xFFFFFFFF;
    const Fields fields(object, "segment");
    return {.id = static_cast<std::uint32_t>(fields.integer("segment", 0, most)),
            .slots = static_cast<std::uint32_t>(fields.integer("slots", 1, 1024)),
            .slot_size = static_cast<std::uint64_t>(fields.integer("slot_size", 1, most))};
}

Body to_body(const Reference& reference)
{
    std::vector<unsigned char> bytes(reference_bytes);
    put_slot(bytes.data(), reference.slot);
    store(bytes.data() + slot_bytes, reference.offset);
    store(bytes.data() + slot_bytes + 8, reference.size);
    return bytes;
}

Reference reference_from_body(const Body& body)
{
    if (body.size() != reference_bytes)
        throw Error(Errc::malformed, "reference: " + std::to_string(body.size()) + " bytes instead of "
                                         + std::to_string(reference_bytes));
    return {get_slot(body.data()), load<std::uint64_t>(body.data() + slot_bytes),
            load<std::uint64_t>(body.data() + slot_bytes + 8)};
}

Body to_body(const std::vector<Slot>& slots)
{
    std::vector<unsigned char> bytes(slots.size() * slot_bytes);
    for (std::size_t i = 0; i < slots.size(); ++i)
        put_slot(bytes.data() + i * slot_bytes, slots[i]);
    return bytes;
}

std::vector<Slot> slots_from_body(const Body& body)
{
    if (body.size() % slot_bytes != 0)
        throw Error(Errc::malformed, "release: " + std::to_string(body.size()) + " bytes are not whole slots");
    std::vector<Slot> slots;
    for (std::size_t at = 0; at < body.size(); at += slot_bytes)
        slots.push_back(get_slot(body.data() + at));
    return slots;
}

}  // namespace hive::protocol

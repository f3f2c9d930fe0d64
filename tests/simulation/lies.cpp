// Splits a stream into packets, and changes one.
#include "lies.hpp"

#include <hive/json.hpp>
#include <hive/protocol/packet.hpp>

#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <vector>

namespace hive::simulation {
namespace {

constexpr std::size_t header_at = 8, body_at = 12;  // sizes in the prefix

std::uint32_t size_at(std::string_view packet, std::size_t at)
{
    static_assert(std::endian::native == std::endian::little);
    std::uint32_t size = 0;
    std::memcpy(&size, packet.substr(at).data(), sizeof(size));
    return size;
}

std::vector<Json*> leaves(Json& json)
{
    if (!json.is_structured())
        return {&json};
    std::vector<Json*> all;
    for (auto& each : json)
        for (auto* const leaf : leaves(each))
            all.push_back(leaf);
    return all;
}

template <class Choices>
Json one_of(const Choices& choices)
{
    return choices[world().chance_of(std::size(choices))];
}

Json number_beside(std::int64_t truth)
{
    const auto any = static_cast<std::int64_t>(world().chance_of(max_json_integer));
    return one_of(std::array<Json, 7>{0, -1, truth + 1, truth - 1, 2 * truth, max_json_integer, any});
}

Json text_beside(const std::string& truth)
{
    return one_of(std::array<Json, 6>{"", "source", "a1", "source.tick", truth + "x", std::string(300, 'x')});
}

/// Usually a plausible value.
Json lie_about(const Json& truth)
{
    if (world().chance(10))
        return one_of(std::array<Json, 5>{nullptr, true, 1.5, Json::array(), Json::object()});
    if (truth.is_number_integer())
        return number_beside(truth.get<std::int64_t>());
    if (truth.is_boolean())
        return !truth.get<bool>();
    return text_beside(truth.is_string() ? truth.get<std::string>() : "");
}

/// Shared by the connections of a process.
struct Liar {
    int before;
    std::function<void(const std::string&)> told;

    std::string say(std::string packet)
    {
        const auto size = size_at(packet, header_at);
        if (size == 0 || before-- != 0)
            return packet;
        auto header = Json::parse(packet.substr(protocol::prefix_size, size));
        const auto all = leaves(header);
        if (all.empty())
            return packet;
        Json& field = *all[world().chance_of(all.size())];
        field = lie_about(field);
        const auto lie = header.dump();
        told(std::string(protocol::token(static_cast<protocol::PacketType>(packet[5]))) + " " + lie);
        const auto new_size = static_cast<std::uint32_t>(lie.size());
        std::memcpy(packet.data() + header_at, &new_size, sizeof(new_size));
        return packet.replace(protocol::prefix_size, size, lie);
    }
};

/// The complete packets of one connection.
class Packets {
public:
    explicit Packets(std::shared_ptr<Liar> liar) : liar_(std::move(liar)) {}

    std::string operator()(const std::string& bytes)
    {
        bytes_ += bytes;
        std::string said;
        while (bytes_.size() >= protocol::prefix_size) {
            const auto size = protocol::prefix_size + size_at(bytes_, header_at) + size_at(bytes_, body_at);
            if (bytes_.size() < size)
                break;
            said += liar_->say(bytes_.substr(0, size));
            bytes_.erase(0, size);
        }
        return said;
    }

private:
    std::shared_ptr<Liar> liar_;
    std::string bytes_;
};

}  // namespace

void let_lie(Process& process, int before, std::function<void(const std::string&)> told)
{
    const auto liar = std::make_shared<Liar>(Liar{before, std::move(told)});
    process.said = [liar] { return Packets(liar); };
}

}  // namespace hive::simulation

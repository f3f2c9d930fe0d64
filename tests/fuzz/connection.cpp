// A whole connection, shared memory included, whose peer sends these bytes: it hands over the same packets and ends in
// the same way however they are cut, and what it hands over is within the limits. Input: one byte for the slicing, then
// the stream.
#include "make_connection.hpp"
#include "require.hpp"

#include <hive/error.hpp>

#include <asio/error.hpp>
#include <asio/post.hpp>

#include <cstring>
#include <fcntl.h>
#include <numeric>
#include <sys/mman.h>
#include <unistd.h>

namespace {

using hive::fuzz::require;
using namespace hive::transport;

constexpr std::size_t shared_bytes = 64 * 1024;

/// Memory as an honest peer would share it, of 16 slots of a page.
int shared_memory()
{
    static const int memory = [] {
        const int descriptor = ::memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING);
        const std::string bytes(shared_bytes, 's');
        require(::pwrite(descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
                "there is memory");
        ::fcntl(descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL);
        return descriptor;
    }();
    return ::fcntl(memory, F_DUPFD_CLOEXEC, 0);
}

/// Gives the bytes in slices, then the end; takes whatever is written. Every third segment comes without memory.
class Script final : public Stream {
public:
    Script(asio::io_context& context, std::string_view bytes, unsigned seed)
        : context_(context), rest_(bytes), seed_(seed)
    {
    }
    void read_some(asio::mutable_buffer into, Handler handler) override
    {
        seed_ = seed_ * 1103515245u + 12345u;
        const auto most = whole() ? into.size() : std::min<std::size_t>(into.size(), 1 + (seed_ >> 16) % 40);
        const auto slice = rest_.substr(0, closed_ ? 0 : most);
        std::memcpy(into.data(), slice.data(), slice.size());
        rest_.remove_prefix(slice.size());
        const auto error = slice.empty() ? std::error_code(asio::error::eof) : std::error_code();
        asio::post(context_, [handler = std::move(handler), error, size = slice.size()] { handler(error, size); });
    }
    void write_some(std::span<const asio::const_buffer> from, Handler handler) override
    {
        const auto size = std::accumulate(from.begin(), from.end(), std::size_t{0},
                                          [](std::size_t sum, const auto& buffer) { return sum + buffer.size(); });
        asio::post(context_, [handler = std::move(handler), size] { handler({}, size); });
    }
    [[nodiscard]] bool passes_descriptors() const noexcept override { return true; }
    Descriptor take_descriptor() override { return ++taken_ % 3 == 0 ? Descriptor() : Descriptor(shared_memory()); }
    void close() noexcept override { closed_ = true; }
    [[nodiscard]] std::string peer() const override { return "fuzz"; }
    [[nodiscard]] bool local() const override { return true; }
    [[nodiscard]] Credentials credentials() const override { return {.role = hive::Role::owner, .key = {}}; }

private:
    [[nodiscard]] bool whole() const { return whole_; }

    asio::io_context& context_;
    std::string_view rest_;
    unsigned seed_;
    bool whole_ = seed_ == 0, closed_ = false;
    int taken_ = 0;
};

/// What the connection made of it.
struct Heard {
    std::vector<std::string> packets;
    int closed = 0;
    std::string reason;
};

std::string described(const hive::protocol::Packet& packet)
{
    const std::string body(reinterpret_cast<const char*>(packet.body.data()), packet.body.size());
    return std::to_string(static_cast<int>(packet.type)) + " " + std::to_string(packet.channel) + " "
           + std::string(packet.header_text()) + " " + body;
}

Heard heard(std::string_view bytes, unsigned seed)
{
    asio::io_context context;
    Heard heard;
    const auto connection = make_connection(context, std::make_unique<Script>(context, bytes, seed), {}, nullptr);
    connection->start(
        {.packet =
             [&](hive::protocol::Packet&& packet) {
                 const bool first = heard.packets.empty();
                 require(heard.closed == 0, "nothing comes after the end");
                 require(first == (packet.type == hive::protocol::PacketType::hello), "a hello is the first packet");
                 require(packet.body.size() <= hive::protocol::Limits{}.body, "a body is within the limit");
                 require(packet.header_text().size() <= hive::protocol::Limits{}.header, "a header is, too");
                 heard.packets.push_back(described(packet));
                 if (first)
                     connection->open({});
             },
         .closed =
             [&](const hive::Error& reason) {
                 ++heard.closed;
                 heard.reason = reason.what();
             },
         .wants =
             [](hive::protocol::PacketType type, std::uint16_t channel) {
                 if (type == hive::protocol::PacketType::halt)
                     throw hive::Error(hive::Errc::not_permitted, "halt");
                 return channel != 9;
             }});
    while (context.poll() > 0) {
    }
    require(heard.closed == 1, "a connection ends once");
    return heard;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size == 0)
        return 0;
    const std::string_view stream(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const auto whole = heard(stream, 0), sliced = heard(stream, 1u + bytes[0]);
    require(whole.packets == sliced.packets, "slices give the same packets");
    require(whole.reason == sliced.reason, "slices end as the whole does");
    return 0;
}

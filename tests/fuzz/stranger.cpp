// The bytes that somebody without the key sends to a listener that wants it: however they are cut, there is an answer
// in words, and never a connection. Input: one byte for the slicing, then the stream.
#include "require.hpp"
#include "tls_handshake.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <unistd.h>

namespace {

using hive::fuzz::require;
using namespace hive::transport;

/// The same in each run, so that a corpus can name it, and can hold a whole hello that proved it once.
std::vector<hive::SwarmKey> keys()
{
    hive::SwarmKey key{.id = "0123456789abcdef"};
    key.secret.fill(7);
    return {key};
}

/// Writes the bytes in slices, and reads what is answered so that nothing waits for room.
class Stranger {
public:
    Stranger(int descriptor, std::string_view bytes, unsigned slice)
        : descriptor_(descriptor), rest_(bytes), slice_(slice)
    {
    }
    ~Stranger() { ::close(descriptor_); }
    Stranger(const Stranger&) = delete;
    Stranger& operator=(const Stranger&) = delete;

    void go_on()
    {
        std::array<char, 4096> answer;
        while (::recv(descriptor_, answer.data(), answer.size(), MSG_DONTWAIT) > 0) {
        }
        const auto most = std::min<std::size_t>(rest_.size(), slice_ == 0 ? rest_.size() : slice_);
        const auto sent = ::send(descriptor_, rest_.data(), most, MSG_DONTWAIT | MSG_NOSIGNAL);
        rest_.remove_prefix(sent > 0 ? static_cast<std::size_t>(sent) : 0);
        if (rest_.empty())
            ::shutdown(descriptor_, SHUT_WR);
    }

private:
    int descriptor_;
    std::string_view rest_;
    unsigned slice_;
};

void refuse(std::string_view bytes, unsigned slice)
{
    std::array<int, 2> ends{};
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends.data()) == 0,
            "there are sockets");
    asio::io_context context;
    Stranger stranger(ends[1], bytes, slice);
    int told = 0;
    const auto handshake = shake_hands(
        adopt_socket(context, AF_UNIX, ends[0]),
        {.end = TlsEnd::listener, .keys = keys(), .limit = std::chrono::seconds(20), .peer = "fuzz", .local = true},
        [&](const hive::Result<std::unique_ptr<Stream>>& stream) {
            ++told;
            const auto* error = std::get_if<hive::Error>(&stream);
            require(error != nullptr, "bytes that were written without the key prove no key");
            require(error->code() != hive::Errc::timeout, "it is known at the end of the bytes at the latest");
            const std::string_view text = error->what();
            require(!text.empty() && text.size() < 500, "it is said in one sentence");
            require(std::ranges::all_of(text, [](char c) { return c >= ' ' && c < 0x7F; }), "and it can be shown");
        });
    while (told == 0) {
        stranger.go_on();
        context.poll();
        context.restart();
    }
    require(told == 1, "it is said once");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size < 2)
        return 0;
    refuse({reinterpret_cast<const char*>(bytes) + 1, size - 1}, bytes[0]);
    return 0;
}

// Packets by hand, over a unix socket.
#include "raw_peer.hpp"

#include <cerrno>
#include <cstring>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace raw {

using Clock = std::chrono::steady_clock;

namespace {

void put_little_endian(std::string& bytes, std::uint32_t number, int size)
{
    for (int i = 0; i < size; ++i)
        bytes += static_cast<char>(number >> (8 * i) & 0xFF);
}

std::uint32_t little_endian(const std::string& bytes, std::size_t at, int size)
{
    std::uint32_t number = 0;
    for (int i = size; i-- > 0;)
        number = number << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return number;
}

sockaddr_un address_of(const std::filesystem::path& socket)
{
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (socket.string().size() >= sizeof address.sun_path)
        throw std::runtime_error(socket.string() + " is too long for a socket");
    std::strcpy(address.sun_path, socket.c_str());
    return address;
}

int wait_until(int descriptor, short what, Clock::time_point until)
{
    pollfd one{descriptor, what, 0};
    const auto left = std::chrono::ceil<Milliseconds>(until - Clock::now());
    return ::poll(&one, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
}

}  // namespace

std::string prefix(int type, int channel, std::uint32_t header_size, std::uint32_t body_size, const std::string& magic,
                   int version)
{
    std::string bytes = magic;
    bytes += static_cast<char>(version);
    bytes += static_cast<char>(type);
    put_little_endian(bytes, static_cast<std::uint32_t>(channel), 2);
    put_little_endian(bytes, header_size, 4);
    put_little_endian(bytes, body_size, 4);
    return bytes;
}

std::string packet(int type, int channel, const std::string& header, const std::string& body)
{
    return prefix(type, channel, static_cast<std::uint32_t>(header.size()), static_cast<std::uint32_t>(body.size()))
           + header + body;
}

std::string hello_packet(const std::string& name, const std::string& kind)
{
    const auto now =
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    return packet(hello, 0, Json{{"name", name}, {"kind", kind}, {"epoch", now}, {"pid", ::getpid()}}.dump());
}

Peer Peer::dial(const std::filesystem::path& socket)
{
    Peer peer(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_un address = address_of(socket);
    if (::connect(peer.descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("cannot connect to " + socket.string() + ": " + std::strerror(errno));
    return peer;
}

Peer Peer::meet(const std::filesystem::path& socket, const std::string& name)
{
    Peer peer = dial(socket);
    peer.send(hello_packet(name));
    const auto first = peer.next();
    if (!first || first->type != hello)
        throw std::runtime_error(socket.string() + " does not say hello");
    peer.first_ = *first;
    return peer;
}

Peer::~Peer() { close(); }

Peer::Peer(Peer&& other) noexcept { *this = std::move(other); }

Peer& Peer::operator=(Peer&& other) noexcept
{
    std::swap(descriptor_, other.descriptor_);
    std::swap(buffer_, other.buffer_);
    std::swap(first_, other.first_);
    std::swap(ended_, other.ended_);
    std::swap(silent_, other.silent_);
    std::swap(last_id_, other.last_id_);
    std::swap(sent_, other.sent_);
    return *this;
}

void Peer::close()
{
    if (descriptor_ >= 0)
        ::close(std::exchange(descriptor_, -1));
    ended_ = true;
}

bool Peer::send(const std::string& bytes, Milliseconds timeout)
{
    const auto until = Clock::now() + timeout;
    sent_ = Clock::now();
    for (std::size_t sent = 0; sent < bytes.size();) {
        const auto count = ::send(descriptor_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (count > 0)
            sent += static_cast<std::size_t>(count);
        else if ((errno != EAGAIN && errno != EINTR) || Clock::now() >= until)
            return false;
        else
            wait_until(descriptor_, POLLOUT, until);
    }
    return true;
}

/// Reads once; false at the end of the stream or of the time.
bool Peer::fill(Clock::time_point until)
{
    if (ended_ || wait_until(descriptor_, POLLIN, until) <= 0)
        return false;
    char bytes[65536];
    const auto count = ::recv(descriptor_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (count > 0) {
        buffer_.append(bytes, static_cast<std::size_t>(count));
        return true;
    }
    if (count < 0 && (errno == EAGAIN || errno == EINTR))
        return true;
    ended_ = true;
    return false;
}

std::optional<Packet> Peer::take()
{
    if (buffer_.size() < 16)
        return std::nullopt;
    if (buffer_.compare(0, 4, "HIVE") != 0 || buffer_[4] != 1)
        throw std::runtime_error("what the other end sends is not the protocol");
    const auto header_size = little_endian(buffer_, 8, 4), body_size = little_endian(buffer_, 12, 4);
    const std::size_t size = std::size_t{16} + header_size + body_size;
    if (buffer_.size() < size)
        return std::nullopt;
    Packet packet{static_cast<unsigned char>(buffer_[5]), static_cast<int>(little_endian(buffer_, 6, 2)),
                  buffer_.substr(16, header_size), buffer_.substr(std::size_t{16} + header_size, body_size)};
    buffer_.erase(0, size);
    return packet;
}

std::optional<Packet> Peer::next(Milliseconds timeout)
{
    const auto until = Clock::now() + timeout;
    for (;;) {
        while (auto packet = take()) {
            if (packet->type == ping && !silent_)
                send(raw::packet(pong, 0, ""));
            if (packet->type != ping && packet->type != pong)
                return packet;
        }
        const auto now = Clock::now();
        if (!silent_ && now - sent_ > Milliseconds(300))
            send(raw::packet(ping, 0, ""));
        if (!fill(std::min(until, now + Milliseconds(300))) && (ended_ || Clock::now() >= until))
            return std::nullopt;
    }
}

std::optional<Packet> Peer::next_of(int type, Milliseconds timeout, const std::function<void(const Packet&)>& seen)
{
    const auto until = Clock::now() + timeout;
    while (auto packet =
               next(std::max(Milliseconds(0), std::chrono::duration_cast<Milliseconds>(until - Clock::now())))) {
        if (packet->type == type)
            return packet;
        if (seen)
            seen(*packet);
    }
    return std::nullopt;
}

Json Peer::ask(int type, Json fields, int channel, const std::string& body, Milliseconds timeout)
{
    fields["id"] = ++last_id_;
    if (!send(packet(type, channel, fields.dump(), body), timeout))
        return nullptr;
    const auto until = Clock::now() + timeout;
    while (auto answer = next_of(
               confirmation, std::max(Milliseconds(0), std::chrono::duration_cast<Milliseconds>(until - Clock::now()))))
        if (Json json = answer->json(); json.at("id") == last_id_)
            return json;
    return nullptr;
}

bool Peer::closed_within(Milliseconds timeout)
{
    const auto until = Clock::now() + timeout;
    while (!ended_ && Clock::now() < until)
        fill(until);
    return ended_;
}

Listener::Listener(const std::filesystem::path& socket)
    : socket_(socket), descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0))
{
    const sockaddr_un address = address_of(socket);
    if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0
        || ::listen(descriptor_, 16) != 0)
        throw std::runtime_error("cannot listen at " + socket.string() + ": " + std::strerror(errno));
}

Listener::~Listener()
{
    ::close(descriptor_);
    std::error_code ignored;
    std::filesystem::remove(socket_, ignored);
}

std::optional<Peer> Listener::accept(Milliseconds timeout)
{
    if (wait_until(descriptor_, POLLIN, Clock::now() + timeout) <= 0)
        return std::nullopt;
    const int descriptor = ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
    return descriptor < 0 ? std::nullopt : std::optional(Peer(descriptor));
}

std::string error_of(const Json& answer)
{
    if (answer.is_null())
        return "no answer";
    return answer.contains("error") ? answer.at("error").at("code").get<std::string>() : "";
}

std::string text_of(const Json& answer)
{
    if (!answer.contains("error"))
        return "";
    const auto advice = answer.at("error").value("advice", "");
    return answer.at("error").value("text", "") + (advice.empty() ? "" : "; " + advice);
}

}  // namespace raw

// A camera of which a test decides each byte: a server in this process, with a thread for each connection.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace hostile {

/// One connection.
class Client {
public:
    explicit Client(int socket, std::atomic<std::size_t>& sent) : socket_(socket), sent_(sent) {}

    /// The next request, with its empty line; empty if the client has left.
    std::string request()
    {
        std::string text;
        for (char byte = 0; !text.ends_with("\r\n\r\n"); text += byte)
            if (::recv(socket_, &byte, 1, 0) != 1)
                return "";
        return text;
    }
    /// False if the client has left.
    bool send(std::string_view bytes)
    {
        while (!bytes.empty()) {
            const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent <= 0)
                return false;
            sent_ += static_cast<std::size_t>(sent);
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        }
        return true;
    }
    /// Sends the same bytes again and again, until so many were sent or the client has left.
    void flood(const std::string& bytes, std::size_t most)
    {
        for (std::size_t sent = 0; sent < most && send(bytes); sent += bytes.size()) {
        }
    }

private:
    int socket_;
    std::atomic<std::size_t>& sent_;
};

class Camera {
public:
    /// @param answer  is called with each request, until the client leaves or the answer is false
    using Answer = std::function<bool(Client&, const std::string& request)>;

    explicit Camera(Answer answer)
        : answer_(std::move(answer)), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const any = reinterpret_cast<sockaddr*>(&address);
        if (::bind(listener_, any, size) != 0 || ::listen(listener_, 64) != 0
            || ::getsockname(listener_, any, &size) != 0)
            throw std::runtime_error("cannot listen");
        port_ = ntohs(address.sin_port);
        acceptor_ = std::jthread([this] { accept_all(); });
    }
    ~Camera()
    {
        ::shutdown(listener_, SHUT_RDWR);
        acceptor_.join();
        for (const int socket : sockets_)
            ::shutdown(socket, SHUT_RDWR);
        threads_.clear();
        for (const int socket : sockets_)
            ::close(socket);
        ::close(listener_);
    }
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    [[nodiscard]] std::string url(const std::string& scheme = "http", const std::string& path = "/video") const
    {
        return scheme + "://127.0.0.1:" + std::to_string(port_) + path;
    }
    [[nodiscard]] std::size_t connections() const { return connections_; }
    [[nodiscard]] std::size_t sent() const { return sent_; }
    /// All requests so far.
    [[nodiscard]] std::string asked() const
    {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

private:
    void accept_all()
    {
        for (int socket; (socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
            ++connections_;
            sockets_.push_back(socket);
            threads_.emplace_back([this, socket] { serve(socket); });
        }
    }
    void serve(int socket)
    {
        Client client(socket, sent_);
        for (std::string request; !(request = client.request()).empty();) {
            {
                const std::lock_guard lock(mutex_);
                asked_ += request;
            }
            if (!answer_(client, request))
                break;
        }
        ::shutdown(socket, SHUT_RDWR);
    }

    Answer answer_;
    int listener_, port_ = 0;
    std::atomic<std::size_t> connections_ = 0, sent_ = 0;
    mutable std::mutex mutex_;
    std::string asked_;
    std::vector<int> sockets_;
    std::vector<std::jthread> threads_;
    std::jthread acceptor_;
};

inline const std::string ok = "HTTP/1.1 200 OK\r\n";
inline const std::string multipart = ok + "Content-Type: multipart/x-mixed-replace; boundary=b\r\n\r\n";

inline std::string part(const std::string& jpeg)
{
    return "--b\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg.size()) + "\r\n\r\n" + jpeg
           + "\r\n";
}

/// A field of a request with its end of line; empty if it has none.
inline std::string field(const std::string& request, const std::string& name)
{
    const auto at = request.find(name + ":");
    return at == std::string::npos ? "" : request.substr(at, request.find('\n', at) + 1 - at);
}
inline std::string sequence(const std::string& request) { return field(request, "CSeq"); }
inline std::string transport(const std::string& request) { return field(request, "Transport"); }

/// A reply of RTSP with this status line and these fields.
inline std::string rtsp(const std::string& request, const std::string& status, const std::string& fields = "",
                        const std::string& content = "")
{
    const auto length = content.empty() ? "" : "Content-Length: " + std::to_string(content.size()) + "\r\n";
    return "RTSP/1.0 " + status + "\r\n" + sequence(request) + fields + length + "\r\n" + content;
}

/// A piece of one picture, over TCP (RFC 2326, section 10.12; RFC 6184, section 5.8).
inline std::string h264_fragment(unsigned number, std::size_t size)
{
    const auto byte = [](std::size_t value) { return static_cast<char>(value & 255); };
    std::string packet{byte(0x80), byte(96), byte(number >> 8), byte(number), 0, 0, 0, 1, 0, 0, 0, 1};
    packet += {byte(0x7C), byte(number == 0 ? 0x85 : 5)};
    packet.append(size, 'x');
    return std::string{'$', 0, byte(packet.size() >> 8), byte(packet.size())} + packet;
}

/// A section of MPEG-2 systems in one packet of a transport stream (ISO 13818-1, sections 2.4.3 and 2.4.4).
inline std::string transport_packet(unsigned pid, unsigned table, const std::string& contents)
{
    std::string section{static_cast<char>(table), static_cast<char>(0xB0), static_cast<char>(contents.size() + 9)};
    section += std::string("\0\1\xC1\0\0", 5) + contents;
    std::uint32_t crc = 0xFFFFFFFF;
    for (const unsigned char byte : section)
        for (unsigned bit = 0; bit < 8; ++bit)
            crc = (crc << 1) ^ (((crc >> 31) ^ (byte >> (7 - bit) & 1U)) != 0 ? 0x04C11DB7 : 0);
    for (int shift = 24; shift >= 0; shift -= 8)
        section += static_cast<char>(crc >> shift);
    std::string packet{'G', static_cast<char>(0x40 | pid >> 8), static_cast<char>(pid), 0x10, 0};
    packet += section;
    packet.resize(188, static_cast<char>(0xFF));
    return packet;
}

/// The tables of one program with so many streams of H.264, again and again.
inline std::string transport_stream(unsigned streams)
{
    std::string map("\xE1\0\xF0\0", 4), tables;
    for (unsigned i = 0; i < streams; ++i)
        map += std::string{0x1B, static_cast<char>(0xE2), static_cast<char>(i), static_cast<char>(0xF0), 0};
    for (int i = 0; i < 20; ++i)
        tables += transport_packet(0, 0, std::string("\0\1\xE1\0", 4)) + transport_packet(0x100, 2, map);
    return tables;
}

/// A valid grey JPEG of one colour, which takes two bits for 64 pixels. More scans say the same again.
inline std::string grey_jpeg(unsigned width, unsigned height, int scans = 1)
{
    const auto bytes = [](std::initializer_list<unsigned> values) {
        std::string text;
        for (const unsigned value : values)
            text += static_cast<char>(value);
        return text;
    };
    const auto table = [&](unsigned kind) {
        return bytes({0xFF, 0xC4, 0, 20, kind, 1}) + std::string(15, '\0') + std::string(1, '\0');
    };
    const std::size_t blocks = std::size_t{(width + 7) / 8} * ((height + 7) / 8);
    std::string jpeg = bytes({0xFF, 0xD8, 0xFF, 0xDB, 0, 67, 0}) + std::string(64, '\1');
    jpeg += bytes({0xFF, 0xC0, 0, 11, 8, height >> 8, height & 255, width >> 8, width & 255, 1, 1, 0x11, 0});
    jpeg += table(0) + table(16);
    for (int scan = 0; scan < scans; ++scan)
        jpeg += bytes({0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0}) + std::string((blocks * 2 + 7) / 8, '\0');
    return jpeg + bytes({0xFF, 0xD9});
}

}  // namespace hostile

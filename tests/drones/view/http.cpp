// Sockets, chunks, parts.
#include "http.hpp"

#include <opencv2/imgcodecs.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace http {
namespace {

using Clock = std::chrono::steady_clock;

sockaddr_in loopback(int port)
{
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

}  // namespace

cv::Mat decoded(const std::string& jpeg)
{
    return cv::imdecode(std::vector<unsigned char>(jpeg.begin(), jpeg.end()), cv::IMREAD_UNCHANGED);
}
cv::Mat Reply::image() const { return decoded(body); }

Client::Client(int port, int receive_bytes) : port_(port), socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
{
    if (receive_bytes > 0)
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
    const auto address = loopback(port);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("nobody listens at port " + std::to_string(port));
}

Client::~Client() { ::close(socket_); }

bool Client::send(const std::string& bytes)
{
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

bool Client::fill(Clock::time_point until)
{
    pollfd ready{socket_, POLLIN, 0};
    const auto left = std::chrono::ceil<Milliseconds>(until - Clock::now()).count();
    if (ended_ || left < 0 || ::poll(&ready, 1, static_cast<int>(left)) <= 0)
        return false;
    char some[65536];
    const auto count = ::recv(socket_, some, sizeof some, 0);
    ended_ = count <= 0;
    if (count > 0)
        raw_.append(some, static_cast<std::size_t>(count));
    return !ended_;
}

Reply Client::reply(Milliseconds timeout)
{
    const auto until = Clock::now() + timeout;
    while (fill(until)) {
    }
    const auto end = raw_.find("\r\n\r\n");
    if (!ended_ || end == raw_.npos)
        return {};
    return {std::stoi(raw_.substr(9, 3)), raw_.substr(0, end), raw_.substr(end + 4)};
}

/// Moves whole chunks from raw_ to body_.
void Client::unchunk()
{
    if (const auto end = raw_.find("\r\n\r\n"); !in_body_ && end != raw_.npos) {
        raw_.erase(0, end + 4);
        in_body_ = true;
    }
    for (std::size_t line; in_body_ && (line = raw_.find("\r\n")) != raw_.npos;) {
        const std::size_t size = std::stoul(raw_.substr(0, line), nullptr, 16);
        if (raw_.size() < line + 2 + size + 2)
            return;
        body_ += raw_.substr(line + 2, size);
        raw_.erase(0, line + 2 + size + 2);
    }
}

std::optional<std::string> Client::next_image(Milliseconds timeout)
{
    const std::string boundary = "--picture\r\n", length = "Content-Length: ";
    const auto until = Clock::now() + timeout;
    do {
        unchunk();
        if (body_.starts_with(boundary))
            body_.erase(0, boundary.size());
        const auto head = body_.find("\r\n\r\n");
        if (head == body_.npos)
            continue;
        const std::size_t size = std::stoul(body_.substr(body_.find(length) + length.size()));
        if (body_.size() < head + 4 + size + 2 + boundary.size())
            continue;
        const std::string image = body_.substr(head + 4, size);
        body_.erase(0, head + 4 + size + 2);
        return image;
    } while (fill(until));
    return std::nullopt;
}

bool Client::more_within(Milliseconds timeout) { return fill(Clock::now() + timeout); }

bool Client::closed_within(Milliseconds timeout)
{
    const auto until = Clock::now() + timeout;
    while (fill(until))
        raw_.clear();
    return ended_;
}

bool Client::ask(const std::string& path)
{
    return send("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + cookie(port_) + "\r\n");
}

std::string cookie(int port, const std::string& said)
{
    return "Cookie: hive-view-" + std::to_string(port) + "=" + said + "\r\n";
}

Reply get(int port, const std::string& path, const std::string& said)
{
    Client client(port);
    client.send("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + cookie(port, said) + "\r\n");
    return client.reply();
}

}  // namespace http

// Standalone Asio over TCP on 127.0.0.1, as a careful user writes it: asio::write of two buffers by the sender, a chain
// of async_read at the receiver, frames behind a length.
#include "../harness/transport.hpp"

#include <asio.hpp>

#include <array>
#include <vector>

namespace hive::bench {
namespace {

using asio::ip::tcp;

tcp::endpoint endpoint_of(const Run& run) { return {asio::ip::address_v4::loopback(), run.port}; }

tcp::socket connected(asio::io_context& context, const Run& run)
{
    for (const auto end = now_ns() + 5 * second;; sleep_for(2 * millisecond)) {
        tcp::socket socket(context);
        asio::error_code problem;
        socket.connect(endpoint_of(run), problem);
        if (!problem) {
            socket.set_option(tcp::no_delay(true));
            return socket;
        }
        if (now_ns() > end)
            throw std::system_error(problem);
    }
}

tcp::socket accepted(tcp::acceptor& acceptor)
{
    auto socket = acceptor.accept();
    socket.set_option(tcp::no_delay(true));
    return socket;
}

/// A frame and its length, as they go out.
struct Outgoing {
    explicit Outgoing(const Run& run) : bytes(run.size) {}
    std::array<asio::const_buffer, 2> fill(const Frame& frame)
    {
        frame.produce(bytes.data());
        size = bytes.size();
        return {asio::buffer(&size, sizeof size), asio::buffer(bytes)};
    }
    std::vector<std::byte> bytes;
    std::uint64_t size = 0;
};

class AsioPublisher : public PushPublisher {
public:
    explicit AsioPublisher(const Run& run) : outgoing_(run)
    {
        tcp::acceptor acceptor(context_, endpoint_of(run));
        for (int i = 0; i < run.subscribers; ++i)
            sockets_.push_back(accepted(acceptor));
    }

private:
    void send(const Frame& frame) override
    {
        const auto buffers = outgoing_.fill(frame);
        asio::error_code gone;  // a subscriber that has had its end
        for (auto& socket : sockets_)
            asio::write(socket, buffers, gone);
    }

    asio::io_context context_{1};
    std::vector<tcp::socket> sockets_;
    Outgoing outgoing_;
};

class AsioSubscriber : public Subscriber {
public:
    explicit AsioSubscriber(const Run& run) : socket_(connected(context_, run)), bytes_(run.size) {}

    void receive(const OnFrame& on_frame) override
    {
        read_next(on_frame);
        context_.run();
    }

private:
    void read_next(const OnFrame& on_frame)
    {
        asio::async_read(socket_, asio::buffer(&size_, sizeof size_), [&](asio::error_code problem, std::size_t) {
            if (!problem && size_ <= bytes_.size())
                read_frame(on_frame);
        });
    }
    void read_frame(const OnFrame& on_frame)
    {
        asio::async_read(socket_, asio::buffer(bytes_.data(), size_), [&](asio::error_code problem, std::size_t count) {
            if (!problem && on_frame(std::span(bytes_).first(count)))
                read_next(on_frame);
        });
    }

    asio::io_context context_{1};
    tcp::socket socket_;
    std::vector<std::byte> bytes_;
    std::uint64_t size_ = 0;
};

class AsioServer : public Server {
public:
    explicit AsioServer(const Run& run) : acceptor_(context_, endpoint_of(run)), socket_(context_), outgoing_(run) {}

    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        serving();
        socket_ = accepted(acceptor_);
        answer_next(on_request);
        context_.run();
    }

private:
    void answer_next(const OnRequest& on_request)
    {
        asio::async_read(socket_, asio::buffer(&request_, sizeof request_), [&](asio::error_code problem, std::size_t) {
            if (problem)
                return;
            const bool more = on_request(request_, frame_);
            asio::async_write(socket_, outgoing_.fill(frame_), [&, more](asio::error_code gone, std::size_t) {
                if (!gone && more)
                    answer_next(on_request);
            });
        });
    }

    asio::io_context context_{1};
    tcp::acceptor acceptor_;
    tcp::socket socket_;
    Request request_{};
    Frame frame_{};
    Outgoing outgoing_;
};

class AsioClient : public Client {
public:
    explicit AsioClient(const Run& run) : socket_(connected(context_, run)), bytes_(run.size) {}

    bool ask(const Request& request, const FrameCheck& check) override
    {
        std::uint64_t size = 0;
        asio::write(socket_, asio::buffer(&request, sizeof request));
        asio::read(socket_, asio::buffer(&size, sizeof size));
        if (size > bytes_.size())
            return false;
        asio::read(socket_, asio::buffer(bytes_.data(), size));
        return check.whole(std::span(bytes_).first(size));
    }

private:
    asio::io_context context_{1};
    tcp::socket socket_;
    std::vector<std::byte> bytes_;
};

class AsioTcp : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override { return std::make_unique<AsioPublisher>(run); }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<AsioSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<AsioServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<AsioClient>(run); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("asio", hive::bench::AsioTcp(), argc, argv); }

// What the machine allows through sockets: blocking calls, one thread, no library. The name of the variant is made of
//
//     tcp | unix  the kind of socket
//     direct      the frame is written from the camera's buffer: the kernel's copy is what produces it. Otherwise it is
//                 produced into a buffer of the sender first
//     b256        256 KB socket buffers instead of the kernel's own choice
//     sealed      the frame is encrypted into another buffer before it is sent, and decrypted into the frame: the
//                 least that TLS has to do
//     prefetch    the client asks for the next frame before it looks at this one
#include "../harness/board.hpp"
#include "../harness/transport.hpp"
#include "seal.hpp"
#include "socket.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace hive::bench {
namespace {

/// Writes frames: a length, then the bytes.
class FrameWriter {
public:
    explicit FrameWriter(const Run& run)
        : direct_(run.is("direct")), buffer_(run.size), sealed_(run.is("sealed") ? Seal::sealed_size(run.size) : 0)
    {
    }

    void write(std::span<const Socket> sockets, const Frame& frame)
    {
        if (!direct_)
            frame.produce(buffer_.data());
        for (std::size_t i = 0; i < sockets.size(); ++i)
            if (direct_)
                write_direct(sockets[i], frame);
            else if (sealed_.empty())
                write_buffer(sockets[i]);
            else
                write_sealed(sockets[i], seals_[i]);
    }

private:
    void write_buffer(const Socket& socket)
    {
        std::uint64_t size = buffer_.size();
        std::array parts{iovec{&size, sizeof size}, iovec{buffer_.data(), buffer_.size()}};
        socket.write(parts);
    }

    void write_sealed(const Socket& socket, Seal& seal)
    {
        std::uint64_t size = buffer_.size();
        seal.close(buffer_, sealed_.data());
        std::array parts{iovec{&size, sizeof size}, iovec{sealed_.data(), sealed_.size()}};
        socket.write(parts);
    }

    void write_direct(const Socket& socket, const Frame& frame) const
    {
        std::uint64_t size = frame.image.size();
        FrameHeader header = frame.header;
        FrameTail tail = frame.header.sequence;
        auto* middle = const_cast<std::byte*>(frame.image.data()) + sizeof header;
        std::array parts{iovec{&size, sizeof size}, iovec{&header, sizeof header}, iovec{middle, size - least_frame},
                         iovec{&tail, sizeof tail}};
        socket.write(parts);
    }

    bool direct_;
    std::vector<std::byte> buffer_;
    std::vector<std::byte> sealed_;
    std::array<Seal, most_subscribers> seals_{Seal(true), Seal(true), Seal(true), Seal(true)};  ///< one for each socket
};

/// Reads frames into one buffer.
class FrameReader {
public:
    explicit FrameReader(const Run& run)
        : buffer_(run.size), sealed_(run.is("sealed") ? Seal::sealed_size(run.size) : 0)
    {
    }

    /// Empty at the end of the stream, or when the frame is larger than it may be.
    std::span<const std::byte> read(const Socket& socket)
    {
        std::uint64_t size = 0;
        if (!socket.read(std::as_writable_bytes(std::span(&size, 1))) || size > buffer_.size())
            return {};
        const auto frame = std::span(buffer_).first(size);
        return (sealed_.empty() ? socket.read(frame) : read_sealed(socket, frame)) ? frame : std::span<std::byte>();
    }

private:
    bool read_sealed(const Socket& socket, std::span<std::byte> frame)
    {
        const auto sealed = std::span(sealed_).first(Seal::sealed_size(frame.size()));
        return socket.read(sealed) && seal_.open(sealed, frame);
    }

    std::vector<std::byte> buffer_;
    std::vector<std::byte> sealed_;
    Seal seal_{false};
};

class SocketPublisher : public PushPublisher {
public:
    explicit SocketPublisher(const Run& run) : writer_(run)
    {
        const auto listener = Socket::listen(run);
        for (int i = 0; i < run.subscribers; ++i)
            sockets_.push_back(listener.accept(run));
    }

private:
    void send(const Frame& frame) override
    {
        try {
            writer_.write(sockets_, frame);
        } catch (const std::exception&) {
            if (frame.header.kind != Kind::end)  // whoever has had its end may be gone
                throw;
        }
    }

    FrameWriter writer_;
    std::vector<Socket> sockets_;
};

class SocketSubscriber : public Subscriber {
public:
    explicit SocketSubscriber(const Run& run) : socket_(Socket::connect(run)), reader_(run) {}

    void receive(const OnFrame& on_frame) override
    {
        for (auto frame = reader_.read(socket_); !frame.empty() && on_frame(frame);)
            frame = reader_.read(socket_);
    }

private:
    Socket socket_;
    FrameReader reader_;
};

class SocketServer : public Server {
public:
    explicit SocketServer(const Run& run) : run_(run), listener_(Socket::listen(run)), writer_(run) {}

    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        serving();
        const auto socket = listener_.accept(run_);
        Request request{};
        Frame answer{};
        for (bool more = true; more && socket.read(std::as_writable_bytes(std::span(&request, 1)));) {
            more = on_request(request, answer);
            writer_.write({&socket, 1}, answer);
        }
    }

private:
    Run run_;
    Socket listener_;
    FrameWriter writer_;
};

class SocketClient : public Client {
public:
    explicit SocketClient(const Run& run) : prefetch_(run.is("prefetch")), socket_(Socket::connect(run)), reader_(run)
    {
    }

    bool ask(const Request& request, const FrameCheck& check) override
    {
        const bool last = request.header.kind == Kind::end;
        if (last && std::exchange(asked_ahead_, false))
            reader_.read(socket_);
        if (!asked_ahead_)
            send(request);
        asked_ahead_ = prefetch_ && !last;
        if (asked_ahead_)
            send(request);
        return check.whole(reader_.read(socket_));
    }

private:
    void send(const Request& request)
    {
        iovec part{const_cast<Request*>(&request), sizeof request};
        socket_.write({&part, 1});
    }

    bool prefetch_, asked_ahead_ = false;
    Socket socket_;
    FrameReader reader_;
};

class RawSock : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override
    {
        return std::make_unique<SocketPublisher>(run);
    }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<SocketSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<SocketServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<SocketClient>(run); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("raw_sock", hive::bench::RawSock(), argc, argv); }

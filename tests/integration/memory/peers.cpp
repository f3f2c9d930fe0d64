// Producing, receiving, and the process that does either.
#include "peers.hpp"

#include <algorithm>
#include <cstring>

namespace memory {

using hive::protocol::make_packet;
using hive::protocol::Packet;
using hive::protocol::PacketType;

namespace {

constexpr std::size_t kept_images = 2;
constexpr int most_ahead = 4;

unsigned char byte_of(int number) { return static_cast<unsigned char>(number * 7 + 1); }

}  // namespace

bool intact(const Body& body)
{
    return body.size() == image_size
           && std::ranges::all_of(body.bytes(), [first = body.bytes()[0]](std::byte byte) { return byte == first; });
}

Producer::Producer(std::shared_ptr<Connection> connection, std::shared_ptr<Pool> pool)
    : connection_(std::move(connection)), pool_(std::move(pool))
{
}

void Producer::start()
{
    connection_->start({.packet =
                            [this](Packet&& packet) {
                                if (packet.type == PacketType::hello) {
                                    connection_->open({});
                                    connection_->share(pool_);
                                } else {
                                    ++asked_;
                                }
                                produce();
                            },
                        .closed = [this](const hive::Error&) { closed_ = true; }});
    connection_->send(make_packet(PacketType::hello, "{}"));
}

void Producer::produce()
{
    for (; sent_ < asked_ + most_ahead; ++sent_) {
        auto loan = pool_->loan(image_size);
        Body body = loan ? Body(std::move(*loan)) : Body(std::vector<unsigned char>(image_size));
        std::memset(const_cast<unsigned char*>(body.data()), byte_of(sent_), image_size);
        const auto carriage = connection_->send(make_packet(PacketType::event, "{}", 1, std::move(body)));
        fallbacks_ += carriage == hive::transport::Carriage::fallback ? 1 : 0;
    }
}

void Receiver::start()
{
    connection_->start({.packet =
                            [this](Packet&& packet) {
                                if (packet.type == PacketType::hello)
                                    connection_->open({});
                                else
                                    take(packet.body);
                            },
                        .closed = [this](const hive::Error&) { closed_ = true; }});
    connection_->send(make_packet(PacketType::hello, "{}"));
}

void Receiver::take(const Body& body)
{
    broken_ += intact(body) && body.data()[0] == byte_of(received_) ? 0 : 1;
    ++received_;
    kept_.push_back(body);
    if (kept_.size() > kept_images)
        kept_.pop_front();
    connection_->send(make_packet(PacketType::request, "{}", 1));
}

int run_peer(const std::string& role, const std::string& path)
{
    asio::io_context context;
    std::unique_ptr<Producer> producer;
    std::unique_ptr<Receiver> receiver;
    hive::transport::dial(
        context, {hive::transport::Address::Scheme::unix_socket, path, 0}, std::chrono::seconds(5), [&](auto dialed) {
            auto connection = value_or_none(std::move(dialed));
            if (!connection)
                return;
            if (role == "producer")
                (producer = std::make_unique<Producer>(std::move(connection), std::make_shared<Pool>()))->start();
            else
                (receiver = std::make_unique<Receiver>(std::move(connection)))->start();
        });
    context.run_for(std::chrono::seconds(20));
    return 0;
}

}  // namespace memory

// The Connection that users hold: a handle that ends the connection when its last copy is destroyed.
#include "connection_core.hpp"
#include "make_connection.hpp"

#include <asio/post.hpp>

namespace hive::transport {
namespace {

/// Owns the core until start(); from then on pending operations own it. So handlers may own the handle without a cycle
/// that would outlive the io_context.
class ConnectionHandle final : public Connection {
public:
    ConnectionHandle(asio::io_context& context, const Stream& stream, std::shared_ptr<ConnectionCore> core)
        : context_(context),
          peer_(stream.peer()),
          local_(stream.local()),
          credentials_(stream.credentials()),
          can_share_(stream.passes_descriptors()),
          unstarted_(std::move(core)),
          core_(unstarted_)
    {
    }
    ConnectionHandle(const ConnectionHandle&) = delete;
    ConnectionHandle& operator=(const ConnectionHandle&) = delete;
    ~ConnectionHandle() override
    {
        if (const auto core = core_.lock())
            core->abandon();
    }

    void start(Handlers handlers) override
    {
        if (const auto core = std::exchange(unstarted_, nullptr))
            core->start(std::move(handlers));
    }
    void open(const protocol::Limits& limits) override
    {
        if (const auto core = core_.lock())
            core->open(limits);
    }
    Carriage send(protocol::Packet packet, Written written) override
    {
        if (const auto core = core_.lock())
            return core->send(std::move(packet), std::move(written));
        if (written)
            asio::post(context_, [written = std::move(written)] { written(false); });
        return Carriage::inside;
    }
    [[nodiscard]] bool has_room(std::size_t control_bytes) const override
    {
        const auto core = core_.lock();
        return !core || core->has_room(control_bytes);
    }
    void ping(std::function<void(bool)> answered) override
    {
        if (const auto core = core_.lock())
            core->ping(std::move(answered));
        else
            asio::post(context_, [answered = std::move(answered)] { answered(false); });
    }
    [[nodiscard]] bool can_share() const override { return can_share_; }
    void share(std::shared_ptr<Pool> pool) override
    {
        if (const auto core = core_.lock())
            core->share(std::move(pool));
    }
    [[nodiscard]] bool shares() const override
    {
        const auto core = core_.lock();
        return core && core->shares();
    }
    void close(const Error& reason) override
    {
        if (const auto core = core_.lock())
            core->end(reason);
    }
    [[nodiscard]] bool ended_by_peer() const override
    {
        const auto core = core_.lock();
        return core && core->ended_by_peer();
    }
    [[nodiscard]] bool seemed_dead() const override
    {
        const auto core = core_.lock();
        return core && core->seemed_dead();
    }
    [[nodiscard]] std::string peer() const override { return peer_; }
    [[nodiscard]] bool local() const override { return local_; }
    [[nodiscard]] const Credentials& credentials() const override { return credentials_; }

private:
    asio::io_context& context_;
    std::string peer_;
    bool local_;
    Credentials credentials_;
    bool can_share_;
    std::shared_ptr<ConnectionCore> unstarted_;
    std::weak_ptr<ConnectionCore> core_;
};

}  // namespace

std::shared_ptr<Connection> make_connection(asio::io_context& context, std::unique_ptr<Stream> stream,
                                            const Timing& timing, std::shared_ptr<void> admission)
{
    const Stream& carrier = *stream;  // the next line moves it into the core
    auto core = std::make_shared<ConnectionCore>(context, std::move(stream), timing, std::move(admission));
    return std::make_shared<ConnectionHandle>(context, carrier, std::move(core));
}

std::shared_ptr<Connection> Connection::create(asio::io_context& context, std::unique_ptr<Stream> stream, Timing timing)
{
    return make_connection(context, std::move(stream), timing, nullptr);
}

}  // namespace hive::transport

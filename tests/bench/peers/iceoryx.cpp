// Eclipse iceoryx 2: frames are produced in loaned chunks, read in place, released; a publisher waits for its
// subscribers. Request and response for round trips. Needs its daemon, iox-roudi, with the pools of roudi.toml.
//
//     bench_iceoryx loan
#include "../harness/transport.hpp"

#include <iceoryx_posh/popo/untyped_client.hpp>
#include <iceoryx_posh/popo/untyped_publisher.hpp>
#include <iceoryx_posh/popo/untyped_server.hpp>
#include <iceoryx_posh/popo/untyped_subscriber.hpp>
#include <iceoryx_posh/popo/wait_set.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>

#include <cstring>
#include <stdexcept>

namespace hive::bench {
namespace {

using namespace iox::popo;

constexpr std::uint32_t line = 64;  ///< chunks begin at a cache line

iox::capro::ServiceDescription service_of(const Run& run)
{
    return {"bench", "frame", iox::capro::IdString_t(iox::cxx::TruncateToCapacity, run.place)};
}

/// Makes this process known to the daemon; to be the first member.
struct Member {
    explicit Member(const Run& run)
    {
        iox::log::LogManager::GetLogManager().SetDefaultLogLevel(iox::log::LogLevel::kError);
        const auto name =
            run.place + "-" + std::to_string(static_cast<int>(run.role)) + "-" + std::to_string(run.index);
        iox::runtime::PoshRuntime::initRuntime(iox::RuntimeName_t(iox::cxx::TruncateToCapacity, name));
    }
};

class IceoryxPublisher : public PushPublisher {
public:
    explicit IceoryxPublisher(const Run& run) : member_(run), publisher_(service_of(run), options()) {}

private:
    static PublisherOptions options()
    {
        PublisherOptions options;
        options.subscriberTooSlowPolicy = ConsumerTooSlowPolicy::WAIT_FOR_CONSUMER;
        return options;
    }
    void send(const Frame& frame) override
    {
        publisher_.loan(static_cast<std::uint32_t>(frame.image.size()), line)
            .and_then([&](auto& chunk) {
                frame.produce(static_cast<std::byte*>(chunk));
                publisher_.publish(chunk);
            })
            .or_else([](auto&) { throw std::runtime_error("no chunk to be had"); });
    }

    Member member_;
    UntypedPublisher publisher_;
};

class IceoryxSubscriber : public Subscriber {
public:
    explicit IceoryxSubscriber(const Run& run) : member_(run), size_(run.size), subscriber_(service_of(run), options())
    {
        waiting_.attachState(subscriber_, SubscriberState::HAS_DATA).or_else([](auto) {
            throw std::runtime_error("cannot wait");
        });
    }

    void receive(const OnFrame& on_frame) override
    {
        bool more = true;
        const auto take = [&] {
            bool taken = false;
            subscriber_.take().and_then([&](const void* chunk) {
                taken = true;
                more = on_frame({static_cast<const std::byte*>(chunk), size_});
                subscriber_.release(chunk);
            });
            return taken;
        };
        while (more) {
            waiting_.wait();
            while (more && take()) {
            }
        }
    }

private:
    static SubscriberOptions options()
    {
        SubscriberOptions options;
        options.queueCapacity = 8;
        options.queueFullPolicy = QueueFullPolicy::BLOCK_PRODUCER;
        return options;
    }

    Member member_;
    std::size_t size_;
    UntypedSubscriber subscriber_;
    WaitSet<> waiting_;
};

class IceoryxServer : public Server {
public:
    explicit IceoryxServer(const Run& run) : member_(run), server_(service_of(run))
    {
        waiting_.attachState(server_, ServerState::HAS_REQUEST).or_else([](auto) {
            throw std::runtime_error("cannot wait");
        });
    }

    void serve(const std::function<void()>& serving, const OnRequest& on_request) override
    {
        serving();
        bool more = true;
        while (more) {
            waiting_.wait();
            for (bool taken = true; more && taken;) {
                taken = false;
                server_.take().and_then([&](const void* request) {
                    taken = true;
                    more = answer(request, on_request);
                });
            }
        }
        sleep_for(50 * millisecond);  // the last answer is taken before the process ends
    }

private:
    bool answer(const void* chunk, const OnRequest& on_request)
    {
        Request request{};
        std::memcpy(&request, chunk, sizeof request);
        Frame frame{};
        const bool more = on_request(request, frame);
        server_.loan(RequestHeader::fromPayload(chunk), static_cast<std::uint32_t>(frame.image.size()), line)
            .and_then([&](void* response) {
                frame.produce(static_cast<std::byte*>(response));
                server_.send(response).or_else([](auto&) { throw std::runtime_error("cannot answer"); });
            });
        server_.releaseRequest(chunk);
        return more;
    }

    Member member_;
    UntypedServer server_;
    WaitSet<> waiting_;
};

class IceoryxClient : public Client {
public:
    explicit IceoryxClient(const Run& run) : member_(run), size_(run.size), client_(service_of(run))
    {
        waiting_.attachState(client_, ClientState::HAS_RESPONSE).or_else([](auto) {
            throw std::runtime_error("cannot wait");
        });
        for (const auto end = now_ns() + 5 * second; client_.getConnectionState() != iox::ConnectionState::CONNECTED;
             sleep_for(2 * millisecond))
            if (now_ns() > end)
                throw std::runtime_error("no server");
    }

    bool ask(const Request& request, const FrameCheck& check) override
    {
        client_.loan(sizeof request, line).and_then([&](void* chunk) {
            std::memcpy(chunk, &request, sizeof request);
            RequestHeader::fromPayload(chunk)->setSequenceId(number_++);
            client_.send(chunk).or_else([](auto&) { throw std::runtime_error("cannot ask"); });
        });
        bool answered = false, right = false;
        while (!answered) {
            waiting_.wait();
            client_.take().and_then([&](const void* response) {
                answered = true;
                right = check.whole({static_cast<const std::byte*>(response), size_});
                client_.releaseResponse(response);
            });
        }
        return right;
    }

private:
    Member member_;
    std::size_t size_;
    UntypedClient client_;
    WaitSet<> waiting_;
    std::int64_t number_ = 0;
};

class Iceoryx : public Transport {
public:
    std::unique_ptr<Publisher> publisher(const Run& run) const override
    {
        return std::make_unique<IceoryxPublisher>(run);
    }
    std::unique_ptr<Subscriber> subscriber(const Run& run) const override
    {
        return std::make_unique<IceoryxSubscriber>(run);
    }
    std::unique_ptr<Server> server(const Run& run) const override { return std::make_unique<IceoryxServer>(run); }
    std::unique_ptr<Client> client(const Run& run) const override { return std::make_unique<IceoryxClient>(run); }
};

}  // namespace
}  // namespace hive::bench

int main(int argc, char** argv) { return hive::bench::row_main("iceoryx", hive::bench::Iceoryx(), argc, argv); }

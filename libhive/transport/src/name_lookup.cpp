// Calls the system's resolver on four separate threads.
#include "name_lookup.hpp"

#include <hive/protocol/defended.hpp>

#include <asio/post.hpp>
#include <asio/thread_pool.hpp>

#include <mutex>
#include <netdb.h>
#include <sys/socket.h>

namespace hive::transport {

/// Shared with the resolving thread; the mutex orders the answer and the cancellation.
struct NameLookup::Question {
    std::mutex mutex;
    asio::io_context* context = nullptr;  ///< null after cancellation
    Handler handler;

    void answer(Endpoints endpoints, std::string error)
    {
        const std::lock_guard lock(mutex);
        if (!context)
            return;
        asio::post(*std::exchange(context, nullptr), [told = std::move(handler), endpoints = std::move(endpoints),
                                                      error = std::move(error)] { told(endpoints, error); });
    }
};

namespace {

// Never destroyed, since a lookup may still hang at the exit of the process.
asio::thread_pool& lookup_threads()
{
    static auto* threads = new asio::thread_pool(4);
    return *threads;
}

NameLookup::Endpoints endpoints_of(const addrinfo* found, std::uint16_t port)
{
    NameLookup::Endpoints endpoints;
    for (; found; found = found->ai_next) {
        asio::ip::tcp::endpoint endpoint;
        if (found->ai_addrlen > endpoint.capacity())
            continue;
        std::memcpy(endpoint.data(), found->ai_addr, found->ai_addrlen);
        endpoint.resize(found->ai_addrlen);
        endpoint.port(port);
        endpoints.push_back(endpoint);
    }
    return endpoints;
}

std::pair<NameLookup::Endpoints, std::string> look_up(const std::string& host, std::uint16_t port)
{
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_ADDRCONFIG;
    addrinfo* found = nullptr;
    if (const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0)
        return {{}, "the name is not known: " + std::string(::gai_strerror(error))};
    auto endpoints = endpoints_of(found, port);
    ::freeaddrinfo(found);
    return {std::move(endpoints), "the name has no address"};
}

}  // namespace

NameLookup::NameLookup(asio::io_context& context, const std::string& host, std::uint16_t port, Handler handler)
    : question_(std::make_shared<Question>())
{
    question_->context = &context;
    question_->handler = std::move(handler);
    const auto look = [question = question_, host, port] {
        auto [endpoints, error] = look_up(host, port);
        question->answer(std::move(endpoints), std::move(error));
    };
    static const bool on_threads = defended("lookup-threads");
    if (on_threads)
        asio::post(lookup_threads(), look);
    else
        look();
}

NameLookup::~NameLookup()
{
    const std::lock_guard lock(question_->mutex);
    question_->context = nullptr;
    question_->handler = nullptr;
}

}  // namespace hive::transport

// Resolves host names outside of the network side: asio's own resolver has one thread, which a dead name server blocks.
#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hive::transport {

/// One lookup; destroying it cancels it, even while the system is still resolving. Used on the network side.
class NameLookup {
public:
    using Endpoints = std::vector<asio::ip::tcp::endpoint>;
    using Handler = std::function<void(Endpoints, const std::string& error)>;  ///< no endpoints: the error says why

    /// The handler is called on the context's thread.
    NameLookup(asio::io_context& context, const std::string& host, std::uint16_t port, Handler handler);
    NameLookup(const NameLookup&) = delete;
    NameLookup& operator=(const NameLookup&) = delete;
    ~NameLookup();

private:
    struct Question;
    std::shared_ptr<Question> question_;
};

}  // namespace hive::transport

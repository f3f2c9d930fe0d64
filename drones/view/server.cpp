// A request for an image waits until the encoder has it, a stream until there is a newer one.
#include "server.hpp"

#include "answer.hpp"
#include "encoder.hpp"
#include "stream.hpp"

namespace view {

class Server::Core final : public hive::http::Site {
public:
    Core(const Settings& settings, const Exchange& exchange)
        : settings_(settings), exchange_(exchange), encoder_(exchange, [this] { wake(); }), server_(settings, *this)
    {
    }
    [[nodiscard]] int port() const noexcept { return server_.port(); }

private:
    std::optional<hive::http::Answer> answer(const Request& request, hive::http::Visit& visit) override;

    const Settings settings_;
    const Exchange& exchange_;
    Encoder encoder_;
    hive::http::Server server_;
};

std::optional<hive::http::Answer> Server::Core::answer(const Request& request, hive::http::Visit& visit)
{
    if (!visit.again)
        visit.mark = exchange_.newest(visit.now).version;
    auto answer = answer_to(request, exchange_, visit.bind, visit.pass, {visit.streams, settings_.streams});
    if (answer.what == Answer::text)
        return answer;
    auto image = encoder_.newest(answer.plain, visit.now);
    if (!image.jpeg || image.version < visit.mark)
        return visit.late ? std::optional<hive::http::Answer>(not_ready()) : std::nullopt;
    if (answer.what == Answer::image)
        answer.bytes = std::move(image.jpeg);
    else
        answer.hive::http::Answer::stream = std::make_shared<Stream>(
            [this, plain = answer.plain](Exchange::Time now) { return encoder_.newest(plain, now); }, settings_.repeat);
    return answer;
}

Server::Server(Settings settings, const Exchange& exchange)
{
    settings.cookie = "hive-view";
    core_ = std::make_unique<Core>(settings, exchange);
}
Server::~Server() = default;
int Server::port() const noexcept { return core_->port(); }
void Server::wake() noexcept { core_->wake(); }

}  // namespace view

// Coroutines on one io_context; what they share needs no lock. No co_await has temporaries with destructors in its
// expression: g++ 12 destroys some of them twice.
#include "server.hpp"

#include "painter.hpp"
#include "request.hpp"
#include "stream_text.hpp"

#include <asio.hpp>

#include <set>
#include <stdexcept>

namespace axis::emulator {
namespace {

using asio::awaitable;
using asio::use_awaitable;
using asio::ip::tcp;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* serial = "00408CEEEEEE";
constexpr std::size_t most_request = 65536, most_part = 64u << 20;

awaitable<void> wait_until(Clock::time_point when)
{
    asio::steady_timer timer(co_await asio::this_coro::executor, when);
    co_await timer.async_wait(use_awaitable);
}

std::string answer_text(const std::string& status, const std::string& type, const std::string& body,
                        const std::string& fields = "")
{
    return "HTTP/1.0 " + status + "\r\nCache-Control: no-cache\r\nConnection: close\r\n" + fields
           + "Content-Type: " + type + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

bool is_stream(const Request& request)
{
    return request.path == "/axis-cgi/mjpg/video.cgi" || request.path == "/mjpg/video.mjpg";
}

std::string plain(const std::string& body) { return answer_text("200 OK", "text/plain; charset=iso-8859-1", body); }
std::string page(const std::string& status, const std::string& fields = "")
{
    return answer_text(status, "text/html", "<html><body>" + status + "</body></html>\r\n", fields);
}

asio::ip::address address_of(const std::string& text)
{
    std::error_code problem;
    const auto address = asio::ip::make_address(text, problem);
    if (problem)
        throw std::invalid_argument("address=" + text + " is no internet address, as 192.0.2.10");
    return address;
}

std::string repeated(const std::string& text, int times)
{
    std::string all;
    for (int i = 0; i < times; ++i)
        all += text;
    return all;
}

}  // namespace

class Server::World {
public:
    explicit World(const ServerSettings& settings)
        : behaviour_(settings.behaviour),
          parameters_(serial),
          login_(settings.owner, serial),
          place_(address_of(settings.address), settings.port),
          camera_(context_),
          control_(context_),
          signals_(context_, SIGTERM, SIGINT)
    {
        open_camera();
        place_ = camera_.local_endpoint();
        open(control_, {asio::ip::make_address("127.0.0.1"), settings.control_port}, "control");
        follow_behaviour();
        asio::co_spawn(context_, accept_control(), asio::detached);
        signals_.async_wait([this](std::error_code, int) { context_.stop(); });
    }

    unsigned short port() const { return place_.port(); }
    unsigned short control_port() const { return control_.local_endpoint().port(); }
    void run() { context_.run(); }

private:
    static void open(tcp::acceptor& acceptor, const tcp::endpoint& place, const std::string& word)
    try {
        acceptor.open(place.protocol());
        acceptor.set_option(tcp::acceptor::reuse_address(true));
        acceptor.bind(place);
        acceptor.listen();
    } catch (const std::system_error& problem) {
        acceptor.close();
        throw std::runtime_error("cannot listen at " + place.address().to_string() + ", " + word + "="
                                 + std::to_string(place.port()) + ": " + problem.code().message());
    }

    void open_camera()
    {
        open(camera_, place_, "port");
        asio::co_spawn(context_, accept_camera(), asio::detached);
    }

    /// Applies the setting `down`.
    void follow_behaviour()
    {
        if (behaviour_.down && camera_.is_open()) {
            camera_.close();
            for (auto* socket : sockets_)
                socket->close();
        } else if (!behaviour_.down && !camera_.is_open()) {
            open_camera();
        }
    }

    awaitable<void> accept_camera()
    {
        while (camera_.is_open()) {
            tcp::socket socket = co_await camera_.async_accept(use_awaitable);
            asio::co_spawn(context_, serve(std::move(socket)),
                           [](std::exception_ptr) {});  // a closing client is normal
        }
    }

    awaitable<void> accept_control()
    {
        while (true) {
            tcp::socket socket = co_await control_.async_accept(use_awaitable);
            asio::co_spawn(context_, serve_control(std::move(socket)), [](std::exception_ptr) {});
        }
    }

    static awaitable<std::optional<Request>> read_request(tcp::socket& socket)
    {
        std::string buffer;
        const auto size = co_await asio::async_read_until(socket, asio::dynamic_buffer(buffer, most_request),
                                                          "\r\n\r\n", use_awaitable);
        auto request = parse_request(std::string_view(buffer).substr(0, size));
        buffer.erase(0, size);
        if (request && request->body_size > 0 && request->body_size < most_request) {
            if (buffer.size() < request->body_size)
                co_await asio::async_read(socket, asio::dynamic_buffer(buffer),
                                          asio::transfer_exactly(request->body_size - buffer.size()), use_awaitable);
            const auto more = parse_query(buffer);
            request->query.insert(request->query.end(), more.begin(), more.end());
        }
        co_return request;
    }

    awaitable<void> serve_control(tcp::socket socket)
    {
        const auto request = co_await read_request(socket);
        const std::string text = request ? plain(control(*request)) : page("400 Bad Request");
        co_await asio::async_write(socket, asio::buffer(text), use_awaitable);
    }

    std::string control(const Request& request)
    {
        try {
            for (const auto& [name, value] : request.query)
                behaviour_.set(name, value);
            follow_behaviour();
        } catch (const std::exception& problem) {
            return std::string("# Error: ") + problem.what() + "\n";
        }
        return behaviour_.text() + "connections=" + std::to_string(connections_)
               + "\nwrong_logins=" + std::to_string(wrong_logins_) + "\nupdates=" + std::to_string(updates_)
               + "\npictures=" + std::to_string(pictures_) + "\n";
    }

    awaitable<void> serve(tcp::socket socket)
    {
        ++connections_;
        const struct Listed {
            std::set<tcp::socket*>& all;
            tcp::socket* own;
            ~Listed() { all.erase(own); }
        } listed{sockets_, *sockets_.insert(&socket).first};
        while (behaviour_.mute)
            co_await wait_until(Clock::now() + 10ms);
        if (const auto request = co_await read_request(socket))
            co_await answer(socket, *request);
        std::error_code ignored;
        socket.shutdown(tcp::socket::shutdown_send, ignored);
    }

    awaitable<void> answer(tcp::socket& socket, const Request& request)
    {
        const auto refusal = refuse(request);
        if (!refusal && is_stream(request) && parameters_.has_resolution(resolution(request))
            && behaviour_.status == 200 && !behaviour_.html) {
            co_await stream(socket, request);
        } else {
            const std::string text = refusal ? *refusal : simple_answer(request);
            co_await send(socket, text);
        }
    }

    /// Answers that do not depend on the request.
    std::optional<std::string> refuse(const Request& request)
    {
        const auto verdict = login_.check(behaviour_.login(), request.method, request.target, request.authorization);
        if (!behaviour_.redirect.empty())
            return page("302 Found", "Location: " + behaviour_.redirect + "\r\n");
        if (behaviour_.foreign)
            return page("404 Not Found");
        if (behaviour_.huge_head)
            return page("200 OK", repeated("X-Filler: " + std::string(88, 'x') + "\r\n", 1024));
        if (behaviour_.unauthorised || verdict != Login::Verdict::welcome)
            return unauthorised(request, verdict);
        return std::nullopt;
    }

    std::string unauthorised(const Request& request, Login::Verdict verdict)
    {
        // A scheme that is no longer accepted, or a stale nonce, is not a wrong password.
        if (!request.authorization.empty() && verdict != Login::Verdict::stale && verdict != Login::Verdict::unknown)
            ++wrong_logins_;
        std::string fields;
        for (const auto& challenge : login_.challenges(behaviour_.login(), verdict))
            fields += "WWW-Authenticate: " + challenge + "\r\n";
        return page("401 Unauthorized", fields);
    }

    std::string simple_answer(const Request& request)
    {
        if (request.path == "/axis-cgi/param.cgi" || request.path == "/axis-cgi/admin/param.cgi")
            return parameter_answer(request);
        if (is_stream(request) || request.path == "/axis-cgi/jpg/image.cgi" || request.path == "/jpg/image.jpg")
            return image_answer(request);
        if (request.path == "/axis-cgi/imagesize.cgi") {
            const std::string size = resolution(request);
            return plain("image width = " + size.substr(0, size.find('x'))
                         + "\r\nimage height = " + size.substr(size.find('x') + 1) + "\r\n");
        }
        return page("404 Not Found");
    }

    std::string parameter_answer(const Request& request)
    {
        const std::string action = request.word("action");
        if (action == "list")
            return plain(parameters_.list(request.word("group")));
        if (action != "update")
            return plain("# Error: unknown action\r\n");
        if (behaviour_.old_firmware && request.path == "/axis-cgi/param.cgi")
            return page("404 Not Found");
        std::vector<std::pair<std::string, std::string>> values;
        for (const auto& one : request.query)
            if (one.first != "action")
                values.push_back(one);
        ++updates_;
        return plain(parameters_.update(values, behaviour_.step));
    }

    std::string resolution(const Request& request) const
    {
        const std::string asked = request.word("resolution");
        return asked.empty() ? parameters_.value("Image.I0.Appearance.Resolution") : asked;
    }

    std::string picture(const Request& request)
    {
        ++pictures_;
        const std::string asked = request.word("compression");
        const int compression = asked.empty() ? parameters_.number("Image.I0.Appearance.Compression")
                                              : std::clamp(std::atoi(asked.c_str()), 0, 100);
        const auto index = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begun_).count() / 40;
        return painter_.jpeg(parameters_, resolution(request), compression, index);
    }

    std::string image_answer(const Request& request)
    {
        if (!parameters_.has_resolution(resolution(request)))
            return page("400 Bad Request");
        if (behaviour_.status != 200 || behaviour_.html)
            return page(std::to_string(behaviour_.status) + " Status");
        const std::string jpeg = picture(request);
        return answer_text("200 OK", "image/jpeg", behaviour_.truncated ? jpeg.substr(0, jpeg.size() / 2) : jpeg);
    }

    double rate(const Request& request) const
    {
        const int asked = std::atoi(request.word("fps").c_str()), set = parameters_.number("Image.I0.Stream.FPS");
        return asked > 0 ? asked : set > 0 ? set : behaviour_.fps;
    }

    awaitable<void> stream(tcp::socket& socket, const Request& request)
    {
        const std::string head = "HTTP/1.0 200 OK\r\nCache-Control: no-cache\r\nConnection: close\r\nContent-Type: "
                                 + stream_type(behaviour_) + "\r\n\r\n";
        co_await send(socket, head);
        const int most = std::atoi(request.word("nbrofframes").c_str());
        const auto period =
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate(request)));
        const auto reached = [](int count, int limit) { return limit >= 0 && count >= limit; };
        auto due = Clock::now();
        for (int count = 0; (most == 0 || count < most) && !reached(count, behaviour_.close_after); ++count) {
            co_await wait_until(due);
            while (behaviour_.stall || reached(count, behaviour_.stall_after))
                co_await wait_until(Clock::now() + 10ms);
            std::string part = stream_part(behaviour_, picture(request));
            if (reached(count, behaviour_.cut_after)) {
                part.resize(part.size() / 2);
                co_await send(socket, part);
                co_return;
            }
            co_await send_endless(socket);
            co_await send(socket, part);
            due = std::max(due + period, Clock::now() - period);
        }
    }

    awaitable<void> send_endless(tcp::socket& socket)
    {
        if (!behaviour_.endless_head && !behaviour_.endless_part)
            co_return;
        std::string begin = "--myboundary\r\n";
        if (behaviour_.endless_part)
            begin += "Content-Type: image/jpeg\r\n\r\n\xFF\xD8";
        co_await send(socket, begin);
        const std::string much(65536, 'x');
        for (std::size_t sent = 0; sent < most_part; sent += much.size())
            co_await send(socket, much);
    }

    /// All at once, or in slices of 50 ms.
    awaitable<void> send(tcp::socket& socket, const std::string& text)
    {
        std::size_t sent = 0;
        while (behaviour_.bytes_per_s > 0 && sent < text.size()) {
            const auto slice = std::min<std::size_t>(text.size() - sent, std::max(1, behaviour_.bytes_per_s / 20));
            co_await asio::async_write(socket, asio::buffer(text.data() + sent, slice), use_awaitable);
            sent += slice;
            co_await wait_until(Clock::now() + 50ms);
        }
        co_await asio::async_write(socket, asio::buffer(text.data() + sent, text.size() - sent), use_awaitable);
    }

    asio::io_context context_;
    Behaviour behaviour_;
    ParameterStore parameters_;
    Login login_;
    Painter painter_;
    tcp::endpoint place_;
    tcp::acceptor camera_, control_;
    asio::signal_set signals_;
    std::set<tcp::socket*> sockets_;
    const Clock::time_point begun_ = Clock::now();
    int connections_ = 0, wrong_logins_ = 0, updates_ = 0, pictures_ = 0;
};

Server::Server(const ServerSettings& settings) : world_(std::make_unique<World>(settings)) {}
Server::~Server() = default;
unsigned short Server::port() const { return world_->port(); }
unsigned short Server::control_port() const { return world_->control_port(); }
void Server::run() { world_->run(); }

}  // namespace axis::emulator

// Runs GNU libmicrohttpd in a loop of ours. Everything except Site::wake() runs on one thread, so nothing here needs a
// lock. A request is suspended until the site has an answer, a stream until it has more to send.
#include "listener.hpp"

#include <hive/http/server.hpp>
#include <hive/platform/crash_signals.hpp>

#include <microhttpd.h>

#include <algorithm>
#include <atomic>
#include <poll.h>
#include <set>
#include <stdexcept>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <unordered_map>

namespace hive::http {
namespace {

using Response = std::unique_ptr<MHD_Response, decltype(&MHD_destroy_response)>;

constexpr auto tick = std::chrono::milliseconds(500);
constexpr std::size_t request_bytes = 16 * 1024;  // of a request's head, and of the data in flight to one browser
constexpr std::size_t on_their_way = 64;          // connections being closed while others arrive
constexpr int socket_bytes = 64 * 1024;  // in the kernel; small, so that a slow browser does not lag further behind

/// One connection is one request, and other pages cannot use ours.
constexpr std::pair<const char*, const char*> headers[]{
    {"Cache-Control", "no-store"},
    {"Connection", "close"},
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"X-Content-Type-Options", "nosniff"},
};

Response response_of(const std::string& body)
{
    return {MHD_create_response_from_buffer(body.size(), const_cast<char*>(body.data()), MHD_RESPMEM_MUST_COPY),
            MHD_destroy_response};
}

Response response_of(Bytes bytes)
{
    auto kept = std::make_unique<Bytes>(std::move(bytes));
    Response response(MHD_create_response_from_buffer_with_free_callback_cls(
                          (*kept)->size(), const_cast<unsigned char*>((*kept)->data()),
                          [](void* of_response) { delete static_cast<Bytes*>(of_response); }, kept.get()),
                      MHD_destroy_response);
    if (response)
        kept.release();  // until the response is destroyed
    return response;
}

}  // namespace

class Server::Core {
public:
    Core(const Settings& settings, Site& site);
    ~Core();
    [[nodiscard]] int port() const noexcept { return port_; }

private:
    /// One connection, which is one request.
    struct Visitor {
        int socket = -1;
        Clock::time_point since;
        enum { asking, waiting, answering, streaming, ended } doing = asking;
        std::uint64_t mark = 0;  ///< of the site
        std::string body{};      ///< received so far
        std::size_t takes = 0;   ///< maximum size of a body for the site
        bool asked = false;      ///< Site::takes() was called
    };
    /// The answer to one request for the stream.
    struct Streaming {
        Core& core;
        MHD_Connection* connection;
        std::shared_ptr<EndlessBody> body;
    };

    void loop();
    int poll_timeout() const;
    void resume();
    void end_the_late();
    void make_room();
    [[nodiscard]] bool full() const;
    [[nodiscard]] Visit visit_of(Visitor& visitor, Clock::time_point now) const;
    bool read_body(MHD_Connection* connection, const Request& request, std::string_view more);
    MHD_Result answer(MHD_Connection* connection, const Request& request);
    MHD_Result send(MHD_Connection* connection, Answer answer);
    void suspend(MHD_Connection* connection);
    Response begin_stream(MHD_Connection* connection, std::shared_ptr<EndlessBody> body);
    void visit(MHD_Connection* connection, MHD_ConnectionNotificationCode what);

    static MHD_Result on_request(void* core, MHD_Connection* connection, const char* path, const char* method,
                                 const char*, const char*, std::size_t* uploaded, void** state);
    static void on_visit(void* core, MHD_Connection* connection, void**, MHD_ConnectionNotificationCode what);
    static ssize_t on_read(void* streaming, std::uint64_t, char* to, std::size_t size);
    static void on_stream_end(void* streaming);

    Settings settings_;
    Site& site_;
    Address address_;
    int port_ = 0;
    Pass pass_{"", ""};
    MHD_Daemon* daemon_ = nullptr;
    std::unordered_map<MHD_Connection*, Visitor> visitors_;
    std::set<MHD_Connection*> waiting_;  ///< suspended
    std::size_t streams_ = 0;
    bool deserted_ = false;  ///< no client was connected when the library last ran
    Clock::time_point ticked_{};
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

Server::Core::Core(const Settings& settings, Site& site)
    : settings_(settings), site_(site), address_(settings.bind, settings.port)
{
    Descriptor socket = listen_at(address_, url_of(settings_.bind, settings_.port));
    port_ = port_of(socket);
    pass_ = Pass(settings_.token, settings_.cookie + "-" + std::to_string(port_));
    daemon_ = MHD_start_daemon(MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &Core::on_request, this,
                               MHD_OPTION_LISTEN_SOCKET, socket.get(), MHD_OPTION_CONNECTION_LIMIT,
                               static_cast<unsigned>(settings_.connections + settings_.strangers + on_their_way),
                               MHD_OPTION_CONNECTION_MEMORY_LIMIT, request_bytes, MHD_OPTION_CONNECTION_TIMEOUT,
                               static_cast<unsigned>(settings_.stalled.count()), MHD_OPTION_NOTIFY_CONNECTION,
                               &Core::on_visit, this, MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END);
    if (!daemon_)
        throw std::runtime_error("cannot serve HTTP at " + url_of(settings_.bind, port_));
    static_cast<void>(socket.release());  // the daemon closes it
    const platform::SignalsBlocked blocked;
    thread_ = std::thread([this] { loop(); });
}

Server::Core::~Core()
{
    ending_ = true;
    site_.wake();
    thread_.join();
    resume();  // suspended connections cannot be closed
    MHD_stop_daemon(daemon_);
}

/// Without clients there is nothing to do, once the library has run to accept new ones.
int Server::Core::poll_timeout() const
{
    MHD_UNSIGNED_LONG_LONG milliseconds = 0;
    const int ours = deserted_ && visitors_.empty() ? -1 : static_cast<int>(tick.count());
    if (MHD_get_timeout(daemon_, &milliseconds) != MHD_YES)
        return ours;
    const int theirs = static_cast<int>(std::min<MHD_UNSIGNED_LONG_LONG>(milliseconds, 60'000));
    return ours < 0 ? theirs : std::min(ours, theirs);
}

void Server::Core::loop()
{
    const int events = MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_EPOLL_FD)->epoll_fd;
    while (!ending_) {
        pollfd ready[]{{events, POLLIN, 0}, {site_.wakes_, POLLIN, 0}};
        ::poll(ready, std::size(ready), poll_timeout());
        std::uint64_t wakes = 0;
        const bool woken = ::read(site_.wakes_, &wakes, sizeof wakes) > 0;
        if (woken || Clock::now() - ticked_ >= tick) {
            ticked_ = Clock::now();
            end_the_late();
            resume();
        }
        deserted_ = visitors_.empty();
        MHD_run(daemon_);
    }
}

void Server::Core::suspend(MHD_Connection* connection)
{
    waiting_.insert(connection);
    MHD_suspend_connection(connection);
}

/// Resumes all; a request without an answer is suspended again.
void Server::Core::resume()
{
    for (auto* connection : std::exchange(waiting_, {}))
        MHD_resume_connection(connection);
}

/// A client that sends single bytes is never idle, so the library's own timeout does not apply to it.
void Server::Core::end_the_late()
{
    for (const auto& [connection, visitor] : visitors_) {
        const auto limit = visitor.doing == Visitor::asking ? settings_.asking : settings_.answering;
        if (visitor.doing != Visitor::waiting && visitor.doing != Visitor::streaming
            && Clock::now() - visitor.since > limit)
            ::shutdown(visitor.socket, SHUT_RDWR);
    }
}

void Server::Core::visit(MHD_Connection* connection, MHD_ConnectionNotificationCode what)
{
    if (what == MHD_CONNECTION_NOTIFY_CLOSED) {
        visitors_.erase(connection);
        return;
    }
    const int socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &socket_bytes, sizeof socket_bytes);
    visitors_[connection] = {socket, Clock::now()};
    make_room();
}

/// Evicts the oldest connection without a complete request: a real client sends its request at once.
void Server::Core::make_room()
{
    std::size_t asking = 0;
    Visitor* oldest = nullptr;
    for (auto& [connection, visitor] : visitors_) {
        if (visitor.doing != Visitor::asking)
            continue;
        ++asking;
        if (!oldest || visitor.since < oldest->since)
            oldest = &visitor;
    }
    if (asking <= settings_.strangers)
        return;
    ::shutdown(oldest->socket, SHUT_RDWR);
    oldest->doing = Visitor::ended;
}

/// Are more connections being answered than allowed, including the current one?
bool Server::Core::full() const
{
    const auto answered = std::ranges::count_if(visitors_, [](const auto& row) {
        return row.second.doing != Visitor::asking && row.second.doing != Visitor::ended;
    });
    return static_cast<std::size_t>(answered) > settings_.connections;
}

Visit Server::Core::visit_of(Visitor& visitor, Clock::time_point now) const
{
    return {.bind = address_,
            .pass = pass_,
            .streams = streams_,
            .now = now,
            .again = visitor.doing == Visitor::waiting,
            .mark = visitor.mark};
}

/// Keeps the body as far as the site accepts it, plus one byte to detect a longer one. False: complete, or the site
/// accepts no body.
bool Server::Core::read_body(MHD_Connection* connection, const Request& request, std::string_view more)
{
    auto& visitor = visitors_.at(connection);
    if (!std::exchange(visitor.asked, true)) {
        visitor.takes = site_.takes(request, visit_of(visitor, Clock::now()));
        return visitor.takes > 0;
    }
    visitor.body += more.substr(0, visitor.takes > 0 ? visitor.takes + 1 - visitor.body.size() : 0);
    return visitor.takes > 0 && !more.empty();
}

/// Called again when a suspended request is resumed.
MHD_Result Server::Core::answer(MHD_Connection* connection, const Request& request)
{
    auto& visitor = visitors_.at(connection);
    const auto now = Clock::now();
    auto visit = visit_of(visitor, now);
    visit.late = visit.again && now - visitor.since >= settings_.preparing;
    if (!visit.again) {
        visitor.doing = Visitor::answering;
        visitor.since = now;
    }
    auto answer = !visit.again && full()                ? sentence(503, "Too many viewers.")
                  : visitor.body.size() > visitor.takes ? sentence(413, "The body is too long.")
                                                        : site_.answer(request, visit);
    if (!answer) {
        visitor.doing = Visitor::waiting;
        suspend(connection);
        return MHD_YES;
    }
    visitor.doing = Visitor::answering;
    visitor.since = Clock::now();  // the site may have been slow
    return send(connection, std::move(*answer));
}

MHD_Result Server::Core::send(MHD_Connection* connection, Answer answer)
{
    const Response response = answer.stream  ? begin_stream(connection, std::move(answer.stream))
                              : answer.bytes ? response_of(std::move(answer.bytes))
                                             : response_of(answer.body);
    if (!response)
        return MHD_NO;
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_CONTENT_TYPE, answer.type.c_str());
    MHD_add_response_header(response.get(), MHD_HTTP_HEADER_ALLOW, settings_.allow);
    for (const auto& [name, value] : headers)
        MHD_add_response_header(response.get(), name, value);
    if (!answer.tag.empty())
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_ETAG, answer.tag.c_str());
    if (!answer.cookie.empty()) {
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_SET_COOKIE, answer.cookie.c_str());
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_LOCATION, "/");
    }
    if (answer.code == MHD_HTTP_UNAUTHORIZED)
        MHD_add_response_header(response.get(), MHD_HTTP_HEADER_WWW_AUTHENTICATE, "Bearer");
    return MHD_queue_response(connection, answer.code, response.get());
}

Response Server::Core::begin_stream(MHD_Connection* connection, std::shared_ptr<EndlessBody> body)
{
    auto streaming = std::make_unique<Streaming>(Streaming{*this, connection, std::move(body)});
    Response response(MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, request_bytes / 2, &Core::on_read,
                                                        streaming.get(), &Core::on_stream_end),
                      MHD_destroy_response);
    if (response) {
        streaming.release();  // until on_stream_end
        ++streams_;
        visitors_.at(connection).doing = Visitor::streaming;
    }
    return response;
}

ssize_t Server::Core::on_read(void* state, std::uint64_t, char* to, std::size_t size)
{
    auto& [core, connection, body] = *static_cast<Streaming*>(state);
    if (core.ending_)
        return MHD_CONTENT_READER_END_OF_STREAM;
    try {
        const auto count = body->read({to, size}, Clock::now());
        if (count == 0)
            core.suspend(connection);
        return static_cast<ssize_t>(count);
    } catch (const std::exception&) {  // no memory: only this stream ends
        return MHD_CONTENT_READER_END_WITH_ERROR;
    }
}

void Server::Core::on_stream_end(void* state)
{
    const std::unique_ptr<Streaming> streaming(static_cast<Streaming*>(state));
    streaming->core.waiting_.erase(streaming->connection);
    --streaming->core.streams_;
}

/// Called when the head of a request is complete, and answers it then, unless the site accepts a body. Then it is
/// called again with each piece, and without any at the end.
MHD_Result Server::Core::on_request(void* self, MHD_Connection* connection, const char* path, const char* method,
                                    const char*, const char* piece, std::size_t* size, void**)
{
    auto& core = *static_cast<Core*>(self);
    if (core.ending_)
        return MHD_NO;
    const auto value = [&](MHD_ValueKind kind, const char* name) -> std::optional<std::string_view> {
        const char* const text = MHD_lookup_connection_value(connection, kind, name);
        return text ? std::optional<std::string_view>(text) : std::nullopt;
    };
    try {
        Request request{.method = method,
                        .path = path,
                        .host = value(MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST),
                        .token = value(MHD_GET_ARGUMENT_KIND, "token").value_or(""),
                        .cookie = value(MHD_COOKIE_KIND, core.pass_.cookie_name().c_str()).value_or(""),
                        .site = value(MHD_HEADER_KIND, "Sec-Fetch-Site").value_or(""),
                        .authorization = value(MHD_HEADER_KIND, MHD_HTTP_HEADER_AUTHORIZATION).value_or(""),
                        .accept = value(MHD_HEADER_KIND, MHD_HTTP_HEADER_ACCEPT).value_or(""),
                        .origin = value(MHD_HEADER_KIND, MHD_HTTP_HEADER_ORIGIN).value_or(""),
                        .content_type = value(MHD_HEADER_KIND, MHD_HTTP_HEADER_CONTENT_TYPE).value_or("")};
        if (core.read_body(connection, request, {piece, std::exchange(*size, 0)}))
            return MHD_YES;
        request.body = core.visitors_.at(connection).body;
        return core.answer(connection, request);
    } catch (const std::exception&) {  // no memory: only this connection ends
        return MHD_NO;
    }
}

void Server::Core::on_visit(void* self, MHD_Connection* connection, void**, MHD_ConnectionNotificationCode what)
{
    static_cast<Core*>(self)->visit(connection, what);
}

Site::Site() : wakes_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
Site::~Site() { ::close(wakes_); }

void Site::wake() noexcept
{
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wakes_, &one, sizeof one);  // full: it is already awake
}

Server::Server(const Settings& settings, Site& site) : core_(std::make_unique<Core>(settings, site)) {}
Server::~Server() = default;
int Server::port() const noexcept { return core_->port(); }

}  // namespace hive::http

// libcurl's multi interface, driven in slices of 100 ms so that our own deadlines hold.
#include "http.hpp"

#include "http_error.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <unistd.h>

namespace axis {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t max_head = 65536;
constexpr int slice_ms = 100;

void start_library_once()
{
    static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT);
    if (started != CURLE_OK)
        throw std::runtime_error("libcurl cannot be initialized");
}

std::string seconds(std::chrono::milliseconds time)
{
    return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

struct Http::Handles {
    CURL* easy = curl_easy_init();
    CURLM* multi = curl_multi_init();
    ~Handles()
    {
        curl_easy_cleanup(easy);
        curl_multi_cleanup(multi);
    }
};

/// One request. libcurl's callbacks must not throw: exceptions of the sink are kept and rethrown when libcurl has
/// returned.
class Http::Transfer {
public:
    Transfer(Handles& handles, const Access& access, const Limits& limits, const Sink& sink)
        : easy_(handles.easy), multi_(handles.multi), access_(access), limits_(limits), sink_(sink)
    {
    }
    ~Transfer() { curl_multi_remove_handle(multi_, easy_); }
    Transfer(const Transfer&) = delete;
    Transfer& operator=(const Transfer&) = delete;

    void run(const std::string& target);

private:
    template <class Value>
    void option(CURLoption name, Value value)
    {
        if (curl_easy_setopt(easy_, name, value) != CURLE_OK)
            throw std::runtime_error("this libcurl is too old or lacks a required feature");
    }

    static curl_socket_t open_socket(void* self, curlsocktype purpose, curl_sockaddr* address);
    static int connected(void* self, char* ip, char* local_ip, int port, int local_port);
    static std::size_t on_head(char* bytes, std::size_t size, std::size_t count, void* self);
    static std::size_t on_body(char* bytes, std::size_t size, std::size_t count, void* self);

    void prepare(const std::string& target);
    void prepare_login();
    void take_head_line(std::string_view line);
    void take_body(std::string_view bytes);
    void head_is_whole();
    template <class Work>
    bool guarded(Work work) noexcept;

    void check_time() const;
    std::optional<CURLcode> outcome() const;
    void finish(CURLcode code);

    CURL* easy_;
    CURLM* multi_;
    const Access& access_;
    const Limits& limits_;
    const Sink& sink_;
    Head head_;
    std::size_t head_size_ = 0;
    bool head_sent_ = false, connected_ = false;
    std::string blocked_;  ///< the forbidden address
    std::exception_ptr thrown_;
    const Clock::time_point started_ = Clock::now();
    Clock::time_point last_byte_ = started_;
};

curl_socket_t Http::Transfer::open_socket(void* self, curlsocktype, curl_sockaddr* address)
{
    auto& transfer = *static_cast<Transfer*>(self);
    if (!transfer.access_.addresses.allows(address->addr)) {
        transfer.blocked_ = address_text(address->addr);
        return CURL_SOCKET_BAD;
    }
    return ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
}

int Http::Transfer::connected(void* self, char*, char*, int, int)
{
    auto& transfer = *static_cast<Transfer*>(self);
    transfer.connected_ = true;
    transfer.last_byte_ = Clock::now();
    return CURL_PREREQFUNC_OK;
}

std::size_t Http::Transfer::on_head(char* bytes, std::size_t size, std::size_t count, void* self)
{
    auto& transfer = *static_cast<Transfer*>(self);
    return transfer.guarded([&] { transfer.take_head_line({bytes, size * count}); }) ? size * count : 0;
}

std::size_t Http::Transfer::on_body(char* bytes, std::size_t size, std::size_t count, void* self)
{
    auto& transfer = *static_cast<Transfer*>(self);
    return transfer.guarded([&] { transfer.take_body({bytes, size * count}); }) ? size * count : 0;
}

template <class Work>
bool Http::Transfer::guarded(Work work) noexcept
{
    try {
        last_byte_ = Clock::now();
        work();
        return true;
    } catch (...) {
        thrown_ = std::current_exception();
        return false;
    }
}

void Http::Transfer::prepare(const std::string& target)
{
    option(CURLOPT_URL, (access_.url.text() + target).c_str());
    option(CURLOPT_PROTOCOLS_STR, "http,https");
    option(CURLOPT_FOLLOWLOCATION, 0L);
    option(CURLOPT_PROXY, "");
    option(CURLOPT_NETRC, static_cast<long>(CURL_NETRC_IGNORED));
    option(CURLOPT_NOSIGNAL, 1L);
    option(CURLOPT_USERAGENT, "hive");
    option(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(limits_.connecting.count()));
    option(CURLOPT_OPENSOCKETFUNCTION, &Transfer::open_socket);
    option(CURLOPT_OPENSOCKETDATA, this);
    option(CURLOPT_PREREQFUNCTION, &Transfer::connected);
    option(CURLOPT_PREREQDATA, this);
    option(CURLOPT_HEADERFUNCTION, &Transfer::on_head);
    option(CURLOPT_HEADERDATA, this);
    option(CURLOPT_WRITEFUNCTION, &Transfer::on_body);
    option(CURLOPT_WRITEDATA, this);
    if (!access_.certificate.empty()) {
        option(CURLOPT_CAINFO, access_.certificate.c_str());
        option(CURLOPT_CAPATH, nullptr);  // otherwise those of the system would be trusted as well
    }
    prepare_login();
}

/// With two schemes, or digest alone, libcurl first sends a request without a login, and follows the camera's answer.
void Http::Transfer::prepare_login()
{
    if (!access_.credentials)
        return;
    const bool basic = access_.url.encrypted() || access_.basic_over_http;
    option(CURLOPT_HTTPAUTH, static_cast<long>(basic ? CURLAUTH_BASIC | CURLAUTH_DIGEST : CURLAUTH_DIGEST));
    option(CURLOPT_USERNAME, access_.credentials->user.c_str());
    option(CURLOPT_PASSWORD, access_.credentials->password.c_str());
}

/// A login takes two answers; the last one counts.
void Http::Transfer::take_head_line(std::string_view line)
{
    head_size_ += line.size();
    if (head_size_ > max_head)
        throw CameraError(Failure::too_large, "the head of the answer is larger than 64 KiB");
    if (line.starts_with("HTTP/"))
        head_ = {};
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
        line.remove_suffix(1);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
        return;
    std::string name(line.substr(0, colon));
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    line.remove_prefix(std::min(line.find_first_not_of(' ', colon + 1), line.size()));
    if (name == "content-type")
        head_.type = line;
    else if (name == "location")
        head_.location = line;
    else if (name == "www-authenticate")
        head_.challenges.emplace_back(line);
}

void Http::Transfer::head_is_whole()
{
    if (head_sent_)
        return;
    head_sent_ = true;
    curl_easy_getinfo(easy_, CURLINFO_RESPONSE_CODE, &head_.status);
    if (head_.status != 200)
        throw error_of_status(access_, head_);
    sink_.head(head_);
}

void Http::Transfer::take_body(std::string_view bytes)
{
    head_is_whole();
    sink_.bytes(bytes);
}

void Http::Transfer::run(const std::string& target)
{
    prepare(target);
    curl_multi_add_handle(multi_, easy_);
    for (int running = 1; running > 0;) {
        if (curl_multi_perform(multi_, &running) != CURLM_OK)
            throw std::runtime_error("libcurl fails");
        if (thrown_)
            std::rethrow_exception(thrown_);
        if (running > 0) {
            sink_.time();
            check_time();
            curl_multi_poll(multi_, nullptr, 0, slice_ms, nullptr);
        }
    }
    finish(outcome().value_or(CURLE_RECV_ERROR));
}

/// Until there is a connection, libcurl checks the timeout.
void Http::Transfer::check_time() const
{
    const auto now = Clock::now();
    if (now - started_ > limits_.whole)
        throw CameraError(Failure::silent, "no complete answer from " + access_.url.text() + " within "
                                               + seconds(limits_.whole)
                                               + ": the camera or the network is slow; try again");
    if (connected_ && now - last_byte_ > limits_.silence)
        throw CameraError(Failure::silent,
                          "no answer from " + access_.url.text() + ": it accepts connections but sends nothing for "
                              + seconds(limits_.silence) + "; check that it is the camera, or restart the camera");
}

std::optional<CURLcode> Http::Transfer::outcome() const
{
    for (int left = 1; left > 0;)
        if (const CURLMsg* message = curl_multi_info_read(multi_, &left); message && message->msg == CURLMSG_DONE)
            return message->data.result;
    return std::nullopt;
}

void Http::Transfer::finish(CURLcode code)
{
    if (!blocked_.empty())
        throw CameraError(Failure::not_allowed,
                          "the address " + blocked_ + " is not allowed; to allow it, set allow_address=" + blocked_);
    long problem = 0;
    curl_easy_getinfo(easy_, CURLINFO_OS_ERRNO, &problem);
    if (code != CURLE_OK)
        throw error_of_transfer(access_, limits_, code, problem);
    head_is_whole();
}

Http::Http(Access access) : access_(std::move(access)), handles_((start_library_once(), std::make_unique<Handles>()))
{
    if (!handles_->easy || !handles_->multi)
        throw std::runtime_error("libcurl cannot be initialized");
}

Http::~Http() = default;

void Http::fetch(const std::string& target, const Limits& limits, const Sink& sink)
{
    Transfer(*handles_, access_, limits, sink).run(target);
}

Reply Http::get(const std::string& target, const Limits& limits, const std::function<void()>& time)
{
    Reply reply;
    Sink sink;
    sink.time = time;
    sink.head = [&](const Head& head) { reply.type = head.type; };
    sink.bytes = [&](std::string_view bytes) {
        if (reply.body.size() + bytes.size() > limits.body)
            throw CameraError(Failure::too_large, "an answer of more than " + std::to_string(limits.body) + " bytes");
        reply.body += bytes;
    };
    fetch(target, limits, sink);
    return reply;
}

}  // namespace axis

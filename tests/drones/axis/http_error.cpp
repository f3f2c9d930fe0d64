// Maps HTTP status codes and libcurl codes to failures.
#include "http_error.hpp"

#include <doctest/doctest.h>

#include <curl/curl.h>

#include <cerrno>

using namespace axis;

namespace {

const CameraUrl plain{"http", "192.0.2.10", 0}, encrypted{"https", "192.0.2.10", 0};
const Credentials someone{"root", "pass"};

Access access(const CameraUrl& url, std::optional<Credentials> credentials, bool basic_over_http = false)
{
    return {.url = url,
            .credentials = std::move(credentials),
            .basic_over_http = basic_over_http,
            .certificate = {},
            .addresses = {}};
}

Head unauthorised(std::vector<std::string> challenges) { return {401, "text/html", "", std::move(challenges)}; }

Failure of_code(int code, long problem = 0)
{
    return error_of_transfer(access(plain, std::nullopt), {}, code, problem).kind();
}

}  // namespace

TEST_CASE("http errors: a refused login counts only if the password was sent")
{
    const Head basic = unauthorised({"Basic realm=\"AXIS_1\""}),
               digest = unauthorised({"Basic realm=\"AXIS_1\"", "DIGEST realm=\"AXIS_1\", nonce=\"1\""});
    CHECK(error_of_status(access(plain, std::nullopt), digest).kind() == Failure::login_needed);
    CHECK(error_of_status(access(plain, someone), basic).kind() == Failure::login_needed);
    CHECK(error_of_status(access(plain, someone, true), basic).kind() == Failure::login_refused);
    CHECK(error_of_status(access(encrypted, someone), basic).kind() == Failure::login_refused);
    CHECK(error_of_status(access(plain, someone), digest).kind() == Failure::login_refused);
    CHECK(std::string(error_of_status(access(plain, someone), digest).what()).find("pass ") == std::string::npos);
}

TEST_CASE("http errors: other statuses")
{
    const auto error = error_of_status(access(plain, someone), {302, "", "http://a:b@c/d?e", {}});
    CHECK(error.kind() == Failure::redirected);
    CHECK(std::string(error.what()) == "http://192.0.2.10 points to http://***@c/d (302), which is not followed");
    CHECK(error_of_status(access(plain, someone), {404, "", "", {}}).kind() == Failure::not_vapix);
    for (const long status : {204L, 400L, 403L, 500L, 503L})
        CHECK(error_of_status(access(plain, someone), {status, "", "", {}}).kind() == Failure::refused_status);
}

TEST_CASE("http errors: each transfer error has its own failure")
{
    CHECK(of_code(CURLE_COULDNT_RESOLVE_HOST) == Failure::unknown_host);
    CHECK(of_code(CURLE_COULDNT_CONNECT, ECONNREFUSED) == Failure::refused);
    CHECK(of_code(CURLE_COULDNT_CONNECT, EHOSTUNREACH) == Failure::no_route);
    CHECK(of_code(CURLE_OPERATION_TIMEDOUT) == Failure::no_answer);
    CHECK(of_code(CURLE_PEER_FAILED_VERIFICATION) == Failure::insecure);
    CHECK(of_code(CURLE_SSL_CACERT_BADFILE) == Failure::insecure);
    CHECK(of_code(CURLE_UNSUPPORTED_PROTOCOL) == Failure::not_vapix);
    CHECK(of_code(CURLE_PARTIAL_FILE) == Failure::closed);
    CHECK(of_code(CURLE_GOT_NOTHING) == Failure::closed);
}

TEST_CASE("http errors: a certificate that cannot be read any more is named")
{
    Access with_file = access(encrypted, std::nullopt);
    with_file.certificate = "/somewhere/camera.pem";
    const std::string text = error_of_transfer(with_file, {}, CURLE_SSL_CACERT_BADFILE, 0).what();
    CHECK(text
          == "no encrypted connection to https://192.0.2.10: the certificate in /somewhere/camera.pem cannot be read");
}

// Which trouble a status or a code of libcurl is.
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

Trouble of_code(int code, long problem = 0)
{
    return error_of_transfer(access(plain, std::nullopt), {}, code, problem).trouble();
}

}  // namespace

TEST_CASE("http errors: a refused login counts only if the password was sent")
{
    const Head basic = unauthorised({"Basic realm=\"AXIS_1\""}),
               digest = unauthorised({"Basic realm=\"AXIS_1\"", "DIGEST realm=\"AXIS_1\", nonce=\"1\""});
    CHECK(error_of_status(access(plain, std::nullopt), digest).trouble() == Trouble::login_needed);
    CHECK(error_of_status(access(plain, someone), basic).trouble() == Trouble::login_needed);
    CHECK(error_of_status(access(plain, someone, true), basic).trouble() == Trouble::login_refused);
    CHECK(error_of_status(access(encrypted, someone), basic).trouble() == Trouble::login_refused);
    CHECK(error_of_status(access(plain, someone), digest).trouble() == Trouble::login_refused);
    CHECK(std::string(error_of_status(access(plain, someone), digest).what()).find("pass ") == std::string::npos);
}

TEST_CASE("http errors: other statuses")
{
    const auto error = error_of_status(access(plain, someone), {302, "", "http://a:b@c/d?e", {}});
    CHECK(error.trouble() == Trouble::redirected);
    CHECK(std::string(error.what()) == "http://192.0.2.10 points to http://***@c/d (302), which is not followed");
    CHECK(error_of_status(access(plain, someone), {404, "", "", {}}).trouble() == Trouble::not_vapix);
    for (const long status : {204L, 400L, 403L, 500L, 503L})
        CHECK(error_of_status(access(plain, someone), {status, "", "", {}}).trouble() == Trouble::refused_status);
}

TEST_CASE("http errors: each failure of a transfer is its own trouble")
{
    CHECK(of_code(CURLE_COULDNT_RESOLVE_HOST) == Trouble::unknown_host);
    CHECK(of_code(CURLE_COULDNT_CONNECT, ECONNREFUSED) == Trouble::refused);
    CHECK(of_code(CURLE_COULDNT_CONNECT, EHOSTUNREACH) == Trouble::no_route);
    CHECK(of_code(CURLE_OPERATION_TIMEDOUT) == Trouble::no_answer);
    CHECK(of_code(CURLE_PEER_FAILED_VERIFICATION) == Trouble::insecure);
    CHECK(of_code(CURLE_SSL_CACERT_BADFILE) == Trouble::insecure);
    CHECK(of_code(CURLE_UNSUPPORTED_PROTOCOL) == Trouble::not_vapix);
    CHECK(of_code(CURLE_PARTIAL_FILE) == Trouble::closed);
    CHECK(of_code(CURLE_GOT_NOTHING) == Trouble::closed);
}

TEST_CASE("http errors: a certificate that cannot be read any more is named")
{
    Access with_file = access(encrypted, std::nullopt);
    with_file.certificate = "/somewhere/camera.pem";
    const std::string text = error_of_transfer(with_file, {}, CURLE_SSL_CACERT_BADFILE, 0).what();
    CHECK(text
          == "no encrypted connection to https://192.0.2.10: the certificate in /somewhere/camera.pem cannot be read");
}

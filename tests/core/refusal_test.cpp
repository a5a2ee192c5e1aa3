#include <catch2/catch.hpp>

#include <string>

#include <busbar/core/refusal.hpp>

namespace refusal_test {

using namespace busbar;

namespace {

class OneLine final : public LogSink {
public:
    void write(LogLevel l, std::string_view s, std::string_view t) override
    {
        level = l;
        source = s;
        line = t;
        ++count;
    }

    LogLevel level{LogLevel::Debug};
    std::string source;
    std::string line;
    int count{0};
};

} // namespace

TEST_CASE("a refusal is one line with check, finding, certificate, status, rule and remedy")
{
    const Refusal refusal{status::Bad_CertificateUntrusted,
                          "Trust List Check",
                          "neither it nor an issuer is trusted",
                          "Part 4, 6.1.3, Table 100",
                          "Move it from rejected to trusted",
                          "CN=Line 3",
                          "01AB"};
    OneLine log;
    explain(log, "channel", refusal);
    CHECK(log.count == 1);
    CHECK(log.level == LogLevel::Warning);
    CHECK(log.source == "channel");
    CHECK(log.line == "Trust List Check failed: neither it nor an issuer is trusted (CN=Line 3, "
                      "01AB): Bad_CertificateUntrusted, Part 4, 6.1.3, Table 100. Move it from "
                      "rejected to trusted.");
}

TEST_CASE("the reason of a refusal is for the one who asked")
{
    const Refusal refusal{status::Bad_OutOfRange, "password rules", "it has not 8 to 32 characters",
                          "the configuration", "Choose another one"};
    CHECK(reason_of(refusal) ==
          "password rules: it has not 8 to 32 characters. Choose another one");
    CHECK(reason_of({status::Bad_Timeout, "handshake", {}, {}, {}}) == "handshake");
}

TEST_CASE("what a refusal does not know is left out")
{
    CHECK(text({status::Bad_Timeout, "handshake", {}, {}, {}}) == "handshake failed: Bad_Timeout.");
}

} // namespace refusal_test

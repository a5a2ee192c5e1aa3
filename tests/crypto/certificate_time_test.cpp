#include <catch2/catch.hpp>

#include <busbar/crypto/self_signed.hpp>

#include "crypto/openssl.hpp"
#include "issuing.hpp"

namespace certificate_time_test {

using namespace busbar;
using namespace busbar::test;

namespace {

using Time = std::unique_ptr<ASN1_TIME, crypto::detail::FreeWith<ASN1_TIME_free>>;

struct Row {
    std::int64_t unix_seconds;
    int type;
    const char* text;
};

/// Either side of every limit: of a UTCTime (RFC 5280, 4.1.2.5), of 32 bits with and without sign,
/// of a certificate.
constexpr Row rows[] = {
    {-11'644'473'599, V_ASN1_GENERALIZEDTIME, "16010101000001Z"},
    {-2'147'483'649, V_ASN1_GENERALIZEDTIME, "19011213204551Z"},
    {-631'152'001, V_ASN1_GENERALIZEDTIME, "19491231235959Z"},
    {-631'152'000, V_ASN1_UTCTIME, "500101000000Z"},
    {-1, V_ASN1_UTCTIME, "691231235959Z"},
    {0, V_ASN1_UTCTIME, "700101000000Z"},
    {951'782'400, V_ASN1_UTCTIME, "000229000000Z"},
    {2'147'483'647, V_ASN1_UTCTIME, "380119031407Z"},
    {2'147'483'648, V_ASN1_UTCTIME, "380119031408Z"},
    {2'524'607'999, V_ASN1_UTCTIME, "491231235959Z"},
    {2'524'608'000, V_ASN1_GENERALIZEDTIME, "20500101000000Z"},
    {4'294'967'296, V_ASN1_GENERALIZEDTIME, "21060207062816Z"},
    {253'402'300'799, V_ASN1_GENERALIZEDTIME, "99991231235959Z"},
};

} // namespace

TEST_CASE("a certificate's times are right past the 32 bits of a time_t",
          "[crypto][certificate_time]")
{
    for (const Row& row : rows) {
        INFO(row.text);
        const DateTime time = DateTime::from_unix_seconds(row.unix_seconds);
        const Time made{ASN1_TIME_new()};
        REQUIRE(crypto::detail::set_time(made.get(), time));
        CHECK(ASN1_STRING_type(made.get()) == row.type);
        CHECK(std::string_view{reinterpret_cast<const char*>(ASN1_STRING_get0_data(made.get()))} ==
              row.text);
        CHECK(crypto::detail::date_time_of(made.get()) == time);
    }
}

TEST_CASE("a certificate's times are whole seconds", "[crypto][certificate_time]")
{
    const Time made{ASN1_TIME_new()};
    for (const std::int64_t seconds : {-5, 0, 5}) {
        const DateTime whole = DateTime::from_unix_seconds(seconds);
        REQUIRE(crypto::detail::set_time(made.get(), {whole.ticks + 9'999'999}));
        CHECK(crypto::detail::date_time_of(made.get()) == whole);
    }
    CHECK(crypto::detail::date_time_of(nullptr).is_null());
}

TEST_CASE("a certificate of twenty years is valid for twenty years", "[crypto][certificate_time]")
{
    crypto::CertificateSubject subject;
    subject.common_name = "long";
    subject.application_uri = "urn:test:long";
    subject.valid_from = now;
    const auto made = crypto::create_self_signed(key_number(1), subject);
    REQUIRE(made);
    CHECK(made->valid_from() == now);
    CHECK(made->valid_to() == in_days(20 * 365 + 5));
    CHECK(made->valid_to() == DateTime::from_unix_seconds(2'398'377'600)); // 2046-01-01

    subject.valid_days = 80 * 365;
    const auto long_lived = crypto::create_self_signed(key_number(1), subject);
    REQUIRE(long_lived);
    CHECK(long_lived->valid_to() == in_days(80 * 365));
}

} // namespace certificate_time_test

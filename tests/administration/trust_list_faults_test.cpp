#include "crypto/revoking.hpp"
#include "trust_list_fixture.hpp"

namespace trust_list_faults_test {

// Part 12, 7.8.2: trust lists whose Methods are called wrongly, beyond their limits or while a
// medium fails.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE_METHOD(Lists, "trust list: a handle that nobody has is refused by every Method")
{
    auto admin = log_in();
    const auto closed = open(admin, writing);
    CHECK(status_of(admin, close_method, {Variant{closed}}) == "Good");
    for (const std::uint32_t handle : {std::uint32_t{0}, closed, UINT32_MAX}) {
        const Variant wrong{handle};
        CHECK(status_of(admin, read_method, {wrong, Variant{std::int32_t{1}}}) ==
              "Bad_InvalidArgument");
        CHECK(status_of(admin, write_method, {wrong, Variant{ByteString{}}}) ==
              "Bad_InvalidArgument");
        CHECK(status_of(admin, get_position, {wrong}) == "Bad_InvalidArgument");
        CHECK(status_of(admin, set_position, {wrong, Variant{std::uint64_t{0}}}) ==
              "Bad_InvalidArgument");
        CHECK(status_of(admin, close_and_update, {wrong}) == "Bad_InvalidArgument");
    }
    const auto written = open(admin, writing);
    CHECK(status_of(admin, read_method, {Variant{written}, Variant{std::int32_t{1}}}) ==
          "Bad_InvalidState");
}

TEST_CASE_METHOD(Lists, "trust list: only who may change it may open it for writing")
{
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Engineer"}}, "patience is all", random));
    auto pat = log_in("pat", "patience is all");
    CHECK(status_of(pat, open_method, {Variant{writing}}).starts_with("Bad_"));
    auto admin = log_in();
    CHECK(read(admin, open_count).value == Variant{std::uint16_t{0}});
    static_cast<void>(open(admin, writing));
}

TEST_CASE_METHOD(Lists, "trust list: what readers hold together is limited")
{
    // One list has 400 bytes at least, which is the most of four of 200.
    certificates.max_trust_list_size = 200;
    auto admin = log_in();
    std::size_t count_of_open = 0;
    while (status_of(admin, open_method, {Variant{reading}}) == "Good") {
        REQUIRE(++count_of_open < 16);
    }
    CHECK(status_of(admin, open_method, {Variant{reading}}) == "Bad_TooManyOperations");
    CHECK(read(admin, open_count).value == Variant{static_cast<std::uint16_t>(count_of_open)});
    const Variant der{ByteString{stranger().der()}};
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Bad_RequestTooLarge");
    CHECK(count(applications, StoreList::Trusted) == 1);
}

TEST_CASE_METHOD(Lists, "trust list: was changed last when the last of its folders was")
{
    constexpr std::uint32_t last_update_time = 12662;
    auto admin = log_in();
    const auto last = [&] { return read(admin, last_update_time).value; };
    for (const char* folder : {"issuers/crl", "issuers/certs", "trusted/crl"}) {
        advance(1s);
        storage.set_time(wall_clock.time);
        REQUIRE(storage.remove(folder));
        REQUIRE(storage.make_folder(folder, FileAccess::Owner));
        CHECK(last() == Variant{wall_clock.time});
    }
    storage.set_away(true);
    CHECK(last() == Variant{DateTime{}});
}

TEST_CASE_METHOD(Lists, "trust list: one whose chains have a gap is refused as a whole")
{
    auto admin = log_in();
    log.keeps_records = true;
    const Issued ca = issue(authority("Works CA"), key_number(2));
    const Issued leaf = issue({}, key_number(3), &ca);
    CHECK(replace_trusted(admin, {own_client(), leaf.certificate}) ==
          "Bad_CertificateChainIncomplete");
    CHECK(std::count(log.records.begin(), log.records.end(),
                     "TrustListUpdated Bad_CertificateChainIncomplete /admin 192.0.2.1 "
                     "TrustListId ObjectId MethodId") == 1);
    CHECK(apply(admin) == "Good"); // nothing was changed
    CHECK(count(applications, StoreList::Trusted) == 1);
}

TEST_CASE_METHOD(Lists, "trust list: a CA goes with its revocation lists")
{
    auto admin = log_in();
    const Issued ca = issue(authority("Works CA"), key_number(2));
    const Issued other = issue(authority("Other CA"), key_number(4));
    TrustListDataType data;
    data.specified_lists = 3;
    data.trusted_certificates.push_back(ByteString{own_client().der()});
    for (const Issued* each : {&ca, &other}) {
        data.trusted_certificates.push_back(ByteString{each->certificate.der()});
        data.trusted_crls.push_back(ByteString{revoke(*each).der()});
    }
    const auto handle = open(admin, writing);
    write_all(admin, handle, data);
    REQUIRE(status_of(admin, close_and_update, {Variant{handle}}) == "Good");
    REQUIRE(apply(admin) == "Good");
    REQUIRE(applications.trust_list(today).trusted_crls.size() == 2);
    CHECK(status_of(admin, remove_certificate,
                    {Variant{String{ca.certificate.thumbprint_text()}}, Variant{true}}) == "Good");
    const crypto::TrustList left = applications.trust_list(today);
    CHECK(left.trusted.size() == 2);
    REQUIRE(left.trusted_crls.size() == 1);
    CHECK(left.trusted_crls[0].names_issuer(other.certificate));
}

TEST_CASE_METHOD(Lists, "trust list: a certificate that cannot be removed stays")
{
    auto admin = log_in();
    const Variant der{ByteString{stranger().der()}};
    const Variant thumbprint{String{stranger().thumbprint_text()}};
    REQUIRE(status_of(admin, add_certificate, {der, Variant{true}}) == "Good");
    const auto handle = open(admin, writing);
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) == "Bad_InvalidState");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Good");
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) ==
          "Bad_TransactionPending");
    CHECK(cancel(admin) == "Good");
    const auto reader = open(admin, reading);
    storage.set_protected(true);
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) ==
          "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(count(applications, StoreList::Trusted) == 2);
    // Who reads it meanwhile has nothing to begin anew for.
    CHECK(status_of(admin, read_method, {Variant{reader}, Variant{std::int32_t{9}}}) == "Good");
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) == "Good");
    CHECK(status_of(admin, read_method, {Variant{reader}, Variant{std::int32_t{9}}}) ==
          "Bad_InvalidState");
}

} // namespace trust_list_faults_test

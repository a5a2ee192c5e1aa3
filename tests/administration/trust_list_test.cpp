#include "crypto/revoking.hpp"
#include "trust_list_fixture.hpp"

namespace trust_list_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE_METHOD(Lists, "trust list: is read in pieces, whole and by masks",
                 "[unit:Push Model for Global Certificate and TrustList Management]")
{
    auto admin = log_in();
    const auto handle = open(admin, reading);
    CHECK(read(admin, open_count).value.value_or<std::uint16_t>(0) == 1);
    const auto all = read_all(admin, handle);
    CHECK(all.specified_lists == 15);
    REQUIRE(all.trusted_certificates.size() == 1);
    CHECK(all.trusted_certificates[0] == ByteString{own_client().der()});

    const auto position = on_list(admin, get_position, {Variant{handle}});
    const auto size = position.output_arguments[0].value_or<std::uint64_t>(0);
    CHECK(size > own_client().der().size());
    CHECK(status_of(admin, set_position, {Variant{handle}, Variant{~std::uint64_t{0}}}) == "Good");
    CHECK(on_list(admin, get_position, {Variant{handle}})
              .output_arguments[0]
              .value_or<std::uint64_t>(0) == size);
    CHECK(status_of(admin, set_position, {Variant{handle}, Variant{std::uint64_t{0}}}) == "Good");
    CHECK(read_all(admin, handle) == all);

    CHECK(status_of(admin, read_method, {Variant{handle}, Variant{std::int32_t{-1}}}) ==
          "Bad_InvalidArgument");
    CHECK(status_of(admin, write_method, {Variant{handle}, Variant{ByteString{}}}) ==
          "Bad_InvalidState");
    CHECK(status_of(admin, close_and_update, {Variant{handle}}) == "Bad_InvalidState");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Good");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Bad_InvalidArgument");
    CHECK(status_of(admin, open_method, {Variant{std::uint8_t{2}}}) == "Bad_NotSupported");

    const auto masked = on_list(admin, open_with_masks, {Variant{std::uint32_t{4}}});
    const auto issuers = read_all(admin, masked.output_arguments[0].value_or<std::uint32_t>(0));
    CHECK(issuers.specified_lists == 4);
    CHECK(issuers.trusted_certificates.empty());
}

TEST_CASE_METHOD(Lists, "trust list: what is written counts with ApplyChanges")
{
    auto admin = log_in();
    CHECK(apply(admin) == "Bad_NothingToDo");
    CHECK(cancel(admin) == "Bad_NothingToDo");
    CHECK(read(admin, id::ServerConfiguration_TransactionDiagnostics_Result).status ==
          status::Bad_OutOfService);
    CHECK(replace_trusted(admin, {own_client(), stranger()}) == "Good");
    CHECK(count(applications, StoreList::Trusted) == 1);
    CHECK(read_all(admin, open(admin, reading)).trusted_certificates.size() == 1);

    const auto handle = open(admin, writing);
    CHECK(apply(admin) == "Bad_InvalidState");
    CHECK(status_of(admin, open_method, {Variant{writing}}) == "Bad_NotWritable");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK(count(applications, StoreList::Trusted) == 2);
    CHECK(read(admin, id::ServerConfiguration_TransactionDiagnostics_Result).value ==
          Variant{StatusCode{status::Good}});
    CHECK(read(admin, id::ServerConfiguration_TransactionDiagnostics_AffectedTrustLists)
              .value.array_size() == 1);
    // What is there already keeps its file, and what is not named goes.
    CHECK(replace_trusted(admin, {own_client()}) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK(count(applications, StoreList::Trusted) == 1);
    CHECK(apply(admin) == "Bad_NothingToDo");
}

TEST_CASE_METHOD(Lists, "trust list: who is taken out is out a second later")
{
    auto admin = log_in();
    CHECK(replace_trusted(admin, {stranger()}) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK_FALSE(admin.is_closed());
    advance(1s);
    CHECK(admin.is_closed());
    auto again = connect();
    CHECK(again.is_closed());
}

TEST_CASE_METHOD(Lists, "trust list: a reader is told of a change, and of the end of its file")
{
    auto admin = log_in();
    const auto handle = open(admin, reading);
    CHECK(status_of(admin, add_certificate,
                    {Variant{ByteString{stranger().der()}}, Variant{true}}) == "Good");
    CHECK(status_of(admin, read_method, {Variant{handle}, Variant{std::int32_t{9}}}) ==
          "Bad_InvalidState");
}

TEST_CASE_METHOD(Lists, "trust list: no user has all its handles, with however many sessions")
{
    REQUIRE(user_list.add({"second", {}, 0, {}, {"SecurityAdmin"}}, "patience is all", random));
    auto admin = log_in();
    auto session = log_in();
    const auto writer = open(admin, writing);
    const auto first = open(admin, reading);
    for (int i = 0; i < 14; ++i) {
        static_cast<void>(open(i % 2 == 0 ? admin : session, reading));
    }
    CHECK(status_of(session, open_method, {Variant{reading}}) == "Bad_TooManyOperations");
    auto second = log_in("second", "patience is all");
    CHECK(read_all(second, open(second, reading)).trusted_certificates.size() == 1);
    CHECK(status_of(admin, close_method, {Variant{first}}) == "Bad_InvalidArgument");
    CHECK(status_of(admin, close_method, {Variant{writer}}) == "Good");
}

TEST_CASE_METHOD(Lists, "trust list: certificates come and go one by one")
{
    auto admin = log_in();
    applications.reject(stranger(), today);
    REQUIRE(count(applications, StoreList::Rejected) == 1);
    const Variant der{ByteString{stranger().der()}};
    CHECK(status_of(admin, add_certificate, {der, Variant{false}}) == "Bad_CertificateInvalid");
    CHECK(status_of(admin, add_certificate, {Variant{ByteString{}}, Variant{true}}) ==
          "Bad_CertificateInvalid");
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Good");
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Bad_EntryExists");
    CHECK(count(applications, StoreList::Trusted) == 2);
    CHECK(count(applications, StoreList::Rejected) == 0);

    const Variant thumbprint{String{stranger().thumbprint_text()}};
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{false}}) ==
          "Bad_InvalidArgument");
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) == "Good");
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{true}}) ==
          "Bad_InvalidArgument");

    const auto handle = open(admin, writing);
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Bad_InvalidState");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Good");
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Bad_TransactionPending");
    CHECK(cancel(admin) == "Good");
    log.keeps_records = true;
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Good");
    CHECK(std::count(log.records.begin(), log.records.end(),
                     "TrustListUpdated Good /admin 192.0.2.1 TrustListId ObjectId MethodId") == 1);
}

TEST_CASE_METHOD(Lists, "trust list: each change is told once, by what it is")
{
    auto admin = log_in();
    log.keeps_records = true;
    const auto told = [&] {
        std::vector<std::string> lines;
        for (const std::string& line : std::exchange(log.records, {})) {
            if (line.starts_with("Certificate") || line.starts_with("RevocationList")) {
                lines.push_back(line.substr(0, line.find(" Good")));
            }
        }
        return lines;
    };
    using Told = std::vector<std::string>;
    applications.reject(stranger(), today);
    static_cast<void>(told());
    const Variant der{ByteString{stranger().der()}};
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Good");
    CHECK(told() == Told{"CertificateMoved"});
    CHECK(status_of(admin, remove_certificate,
                    {Variant{String{stranger().thumbprint_text()}}, Variant{true}}) == "Good");
    CHECK(told() == Told{"CertificateRemoved"});

    const Issued ca = issue(authority("Works CA"), key_number(2));
    TrustListDataType data;
    data.specified_lists = 15;
    data.trusted_certificates = {ByteString{own_client().der()}, ByteString{stranger().der()}};
    data.issuer_certificates = {ByteString{ca.certificate.der()}};
    data.issuer_crls = {ByteString{revoke(ca).der()}};
    auto handle = open(admin, writing);
    write_all(admin, handle, data);
    CHECK(status_of(admin, close_and_update, {Variant{handle}}) == "Good");
    CHECK(told().empty());
    CHECK(apply(admin) == "Good");
    CHECK(told() == Told{"CertificateAdded", "CertificateAdded", "RevocationListAdded"});
    data.issuer_certificates = {};
    data.issuer_crls = {};
    handle = open(admin, writing);
    write_all(admin, handle, data);
    CHECK(status_of(admin, close_and_update, {Variant{handle}}) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK(told() == Told{"CertificateRemoved", "RevocationListRemoved"});
}

TEST_CASE_METHOD(Lists, "trust list: an issuer that is needed stays")
{
    auto admin = log_in();
    const Issued ca = issue(authority("Works CA"), key_number(2));
    const Issued leaf = issue({}, key_number(3), &ca);
    const Variant der{ByteString{leaf.certificate.der()}};
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) ==
          "Bad_CertificateChainIncomplete");
    TrustListDataType data;
    data.specified_lists = 4;
    data.issuer_certificates.push_back(ByteString{ca.certificate.der()});
    const auto handle = open(admin, writing);
    write_all(admin, handle, data);
    CHECK(status_of(admin, close_and_update, {Variant{handle}}) == "Good");
    CHECK(apply(admin) == "Good");
    CHECK(count(applications, StoreList::Issuers) == 1);
    CHECK(status_of(admin, add_certificate, {der, Variant{true}}) == "Good");
    const Variant thumbprint{String{ca.certificate.thumbprint_text()}};
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{false}}) ==
          "Bad_CertificateChainIncomplete");
    CHECK(status_of(admin, remove_certificate,
                    {Variant{String{leaf.certificate.thumbprint_text()}}, Variant{true}}) ==
          "Good");
    CHECK(status_of(admin, remove_certificate, {thumbprint, Variant{false}}) == "Good");
}

TEST_CASE_METHOD(Lists, "trust list: a client whose CA is trusted")
{
    auto admin = log_in();
    const Issued ca = issue(authority("Works CA"), key_number(2));
    const Issued leaf = issue({}, key_number(3), &ca);
    const auto add = [&](const Issued& one) {
        return status_of(admin, add_certificate,
                         {Variant{ByteString{one.certificate.der()}}, Variant{true}});
    };
    CHECK(add(leaf) == "Bad_CertificateChainIncomplete");
    CHECK(add(ca) == "Good");
    CHECK(add(leaf) == "Good");
    CHECK(count(applications, StoreList::Trusted) == 2 + 1); // and our own
}

TEST_CASE_METHOD(Lists, "trust list: two administrators")
{
    auto one = log_in();
    auto other = log_in();
    CHECK(replace_trusted(one, {own_client(), stranger()}) == "Good");
    CHECK(status_of(other, open_method, {Variant{writing}}) == "Bad_TransactionPending");
    CHECK(apply(other) == "Bad_SessionIdInvalid");
    CHECK(cancel(other) == "Bad_SessionIdInvalid");
    const auto handle = open(other, reading);
    CHECK(status_of(one, close_method, {Variant{handle}}) == "Bad_InvalidArgument");

    // One goes away: the transaction is over.
    REQUIRE(one.close_session() == status::Good);
    CHECK(replace_trusted(other, {own_client()}) == "Good");
    CHECK(apply(other) == "Good");
    CHECK(count(applications, StoreList::Trusted) == 1);
}

TEST_CASE_METHOD(Lists, "trust list: a client that vanished holds nothing up for ever")
{
    auto one = log_in();
    static_cast<void>(open(one, writing));
    advance(61s); // the session's timeout
    auto other = log_in();
    CHECK(read(other, open_count).value.value_or<std::uint16_t>(9) == 0);
    CHECK(replace_trusted(other, {own_client()}) == "Good");
}

TEST_CASE_METHOD(Lists, "trust list: bytes that make no sense are refused, and the file is closed")
{
    auto admin = log_in();
    const auto refused = [&](std::vector<std::byte> bytes) {
        const auto handle = open(admin, writing);
        CHECK(status_of(admin, write_method, {Variant{handle}, Variant{ByteString{bytes}}}) ==
              "Good");
        const auto status = status_of(admin, close_and_update, {Variant{handle}});
        CHECK(status_of(admin, close_method, {Variant{handle}}) == "Bad_InvalidArgument");
        return status;
    };
    CHECK(refused({}) == "Bad_InvalidArgument");
    CHECK(refused(std::vector<std::byte>(100, std::byte{0xFF})) == "Bad_InvalidArgument");
    std::vector<std::byte> empty(20, std::byte{});
    CHECK(refused(empty) == "Good");
    empty.push_back(std::byte{});
    CHECK(refused(empty) == "Bad_InvalidArgument");

    TrustListDataType data;
    data.specified_lists = 1;
    data.trusted_certificates.push_back(ByteString{std::vector<std::byte>(10, std::byte{1})});
    const auto handle = open(admin, writing);
    write_all(admin, handle, data);
    CHECK(status_of(admin, close_and_update, {Variant{handle}}) == "Bad_CertificateInvalid");
    CHECK(apply(admin) == "Good"); // nothing was changed
    CHECK(count(applications, StoreList::Trusted) == 1);
}

TEST_CASE_METHOD(Lists, "trust list: sizes and numbers have limits")
{
    certificates.max_trust_list_size = 5'000;
    auto admin = log_in();
    const auto handle = open(admin, writing);
    const Variant much{ByteString{std::vector<std::byte>(3'000)}};
    CHECK(status_of(admin, write_method, {Variant{handle}, much}) == "Good");
    CHECK(status_of(admin, write_method, {Variant{handle}, much}) == "Bad_RequestTooLarge");
    CHECK(status_of(admin, close_method, {Variant{handle}}) == "Good");
    for (int i = 0; i < 16; ++i) {
        static_cast<void>(open(admin, reading));
    }
    CHECK(status_of(admin, open_method, {Variant{reading}}) == "Bad_TooManyOperations");
}

TEST_CASE_METHOD(Lists, "trust list: a medium that fails leaves all as it was")
{
    auto admin = log_in();
    CHECK(replace_trusted(admin, {stranger()}) == "Good");
    storage.set_protected(true);
    CHECK(apply(admin) == "Bad_ResourceUnavailable");
    CHECK(
        status_of(admin, add_certificate, {Variant{ByteString{stranger().der()}}, Variant{true}}) ==
        "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(apply(admin) == "Bad_NothingToDo");
    REQUIRE(count(applications, StoreList::Trusted) == 1);
    CHECK(applications.list(StoreList::Trusted)[0].thumbprint == own_client().thumbprint_text());
}

TEST_CASE_METHOD(Lists, "trust list: users have one of their own")
{
    auto admin = log_in();
    const Variant der{ByteString{stranger().der()}};
    CHECK(call(admin, NodeId{0, user_trust_list}, NodeId{0, user_add_certificate},
               {der, Variant{true}})
              .status_code == status::Good);
    CHECK(count(user_certificates, StoreList::Trusted) == 1);
    CHECK(count(applications, StoreList::Trusted) == 1);
    CHECK(storage.entry("users/trusted/certs"));
}

TEST_CASE_METHOD(Lists, "trust list: is nobody's business but SecurityAdmin's")
{
    auto admin = log_in();
    REQUIRE(user_list.add({"pat", {}, 0, {}, {"Operator", "ConfigureAdmin"}}, "patience is all",
                          random));
    auto pat = log_in("pat", "patience is all");
    CHECK(status_of(pat, open_method, {Variant{reading}}) == "Bad_NodeIdUnknown");
    CHECK(read(pat, open_count).status.is_bad());
}

} // namespace trust_list_test

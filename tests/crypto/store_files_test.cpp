#include <busbar/crypto/certificate_store.hpp>

#include "revoking.hpp"
#include "store_fixture.hpp"

namespace store_files_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::RejectedFull;
using crypto::StoreLimits;
using crypto::StoreList;

namespace {

Certificate stranger()
{
    return issue({}, key_number(1)).certificate;
}

[[nodiscard]] DateTime in_seconds(std::int64_t seconds)
{
    return {now.ticks + seconds * DateTime::ticks_per_second};
}

/// Files are as old as a test says.
void set_age(const fs::path& file, std::chrono::seconds age)
{
    fs::last_write_time(file, fs::file_time_type::clock::now() - age);
}

std::vector<std::size_t> trusted_sizes(StoreFixture& fixture)
{
    const auto& trust = fixture.store.trust_list(long_after());
    return {trust.trusted.size(), trust.trusted_crls.size()};
}

} // namespace

TEST_CASE("files count as soon as they are there and no longer", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate a = stranger();
    const Certificate b = stranger();
    const auto list = revoke(issue(authority("root"), key_number(2)));
    CHECK(fixture.store.trust_list(now).trusted.empty());
    fixture.put("trusted/certs/any name.crt", a.der());
    CHECK(fixture.store.trust_list(now).trusted == std::vector{a});
    fixture.put("trusted/crl/x", pem_of(list));
    CHECK(fixture.store.trust_list(now).trusted_crls == std::vector{list});
    // An operation in between does not hide the change.
    fixture.put("trusted/certs/b.der", b.der());
    CHECK(fixture.in(StoreList::Trusted).size() == 3);
    CHECK(fixture.store.trust_list(long_after()).trusted == std::vector{a, b});
    fs::rename(fixture.path("trusted/certs/b.der"), fixture.path("issuers/certs/b.der"));
    CHECK(fixture.store.trust_list(long_after()).trusted == std::vector{a});
    CHECK(fixture.store.trust_list(long_after()).issuers == std::vector{b});
    fs::remove_all(fixture.folder.path);
    CHECK(fixture.store.trust_list(long_after()).trusted.empty());
    CHECK(fixture.log.count("trusted/certs cannot be read") == 1);
    CHECK(fixture.store.trust_list(long_after()).issuers.empty());
    CHECK(fixture.log.count("trusted/certs cannot be read") == 1);
}

TEST_CASE("a file that is replaced at once by one of the same size is noticed", "[crypto][store]")
{
    StoreFixture fixture;
    const Certificate a = stranger();
    Certificate b = stranger();
    while (b.der().size() != a.der().size()) {
        b = stranger();
    }
    const fs::path file = fixture.path("trusted/certs/x.der");
    // The clock of files stands still for some of these rounds; the validator's is behind it.
    for (int i = 0; i < 300; ++i) {
        const Certificate& one = i % 2 == 0 ? a : b;
        if (i % 3 == 0) {
            write_file(file.string() + ".tmp", one.der());
            fs::rename(file.string() + ".tmp", file);
        } else {
            write_file(file, one.der());
        }
        REQUIRE(fixture.store.trust_list(now).trusted == std::vector{one});
    }
}

TEST_CASE("what is no certificate does no harm and is told once", "[crypto][store][hostile]")
{
    StoreLimits limits;
    limits.max_certificate_file_size = 20'000;
    StoreFixture fixture{limits};
    const Certificate good = stranger();
    fixture.put("trusted/certs/good.der", good.der());
    fixture.put("trusted/certs/half.der", good.der().first(good.der().size() - 1));
    auto long_one = std::vector(good.der().begin(), good.der().end());
    long_one.push_back(std::byte{0});
    fixture.put("trusted/certs/longer.der", long_one);
    auto two = pem_of(good);
    const auto second = pem_of(stranger());
    two.insert(two.end(), second.begin(), second.end());
    fixture.put("trusted/certs/two.pem", two);
    write_text(fixture.path("trusted/certs/empty"), "");
    write_text(fixture.path("trusted/certs/notes\n.txt"), "no certificate");
    write_text(fixture.path("trusted/certs/giant"), "");
    fs::resize_file(fixture.path("trusted/certs/giant"), 1U << 24U); // takes no place
    // A certificate that OpenSSL would ask a terminal's passphrase for.
    write_text(fixture.path("trusted/certs/locked.pem"),
               "-----BEGIN CERTIFICATE-----\nProc-Type: 4,ENCRYPTED\n"
               "DEK-Info: AES-256-CBC,00112233445566778899AABBCCDDEEFF\n\n"
               "AAAAAAAAAAAAAAAAAAAAAA==\n-----END CERTIFICATE-----\n");
    fs::create_directory(fixture.path("trusted/certs/folder.der"));
    fixture.put("outside.der", stranger().der());
    fs::create_symlink(fixture.path("outside.der"), fixture.path("trusted/certs/link.der"));
    fs::create_symlink("nowhere", fixture.path("trusted/certs/dangling"));
    fs::create_symlink("/dev/zero", fixture.path("trusted/certs/endless"));
    REQUIRE(::mkfifo(fixture.path("trusted/certs/pipe").c_str(), 0600) == 0);
    fixture.put("trusted/crl/certificate.crl", good.der());

    for (const DateTime time : {now, now, long_after()}) {
        CHECK(fixture.store.trust_list(time).trusted == std::vector{good});
        CHECK(fixture.store.trust_list(time).trusted_crls.empty());
    }
    CHECK(fixture.log.lines.size() == 12);
    CHECK(fixture.log.count("trusted/certs/half.der is not a certificate") == 1);
    CHECK(fixture.log.count("trusted/certs/giant is too large") == 1);
    CHECK(fixture.log.count("two.pem holds several certificates") == 1);
    CHECK(fixture.log.count("links are not followed") == 4);
    CHECK(fixture.log.count("is not a revocation list") == 1);
    CHECK(fixture.log.count("\n") == 0);
    // A change is told again, and what is mended counts.
    fixture.put("trusted/certs/half.der", good.der().first(1));
    CHECK(fixture.store.trust_list(now).trusted.size() == 1);
    CHECK(fixture.log.count("half.der is not a certificate") == 2);
    fixture.put("trusted/certs/half.der", good.der());
    CHECK(fixture.store.trust_list(now).trusted.size() == 2);
    CHECK(fixture.log.lines.size() == 13);
}

TEST_CASE("crowded folders are read within limits", "[crypto][store][hostile]")
{
    StoreLimits limits;
    limits.max_files = 20;
    limits.max_certificates = 3;
    limits.max_revocation_lists = 1;
    StoreFixture fixture{limits};
    const Issued root = issue(authority("root"), key_number(2));
    for (const char* name : {"a", "b", "c", "d", "e"}) {
        fixture.put("trusted/certs/" + std::string{name}, stranger().der());
        fixture.put("trusted/crl/" + std::string{name}, revoke(root).der());
    }
    CHECK(trusted_sizes(fixture) == std::vector<std::size_t>{3, 1});
    CHECK(trusted_sizes(fixture) == std::vector<std::size_t>{3, 1});
    CHECK(fixture.log.count("more files than its limit") == 1);
    for (int i = 0; i < 3'000; ++i) {
        write_text(fixture.path("trusted/certs/junk" + std::to_string(i)), "");
    }
    CHECK(trusted_sizes(fixture)[0] <= 3);
    CHECK(fixture.log.count("has too many files") == 1);
    CHECK(fixture.log.lines.size() < 30);
    CHECK_FALSE(fixture.store.add(StoreList::Trusted, stranger().der()));
}

TEST_CASE("a folder's bytes are limited", "[crypto][store][hostile]")
{
    const Certificate a = stranger();
    StoreLimits limits;
    limits.max_folder_size = 2 * a.der().size() + 100;
    StoreFixture fixture{limits};
    for (const char* name : {"1", "2", "3"}) {
        fixture.put("trusted/certs/" + std::string{name}, a.der());
    }
    CHECK(trusted_sizes(fixture)[0] == 2);
    CHECK(fixture.log.count("trusted/certs/3 is beyond the limit") == 1);
    fs::remove(fixture.path("trusted/certs/1"));
    CHECK(trusted_sizes(fixture)[0] == 2);
}

TEST_CASE("strangers do not fill the disk", "[crypto][store][hostile]")
{
    // tests/attacks.txt, G2.
    const auto limits = GENERATE(crypto::nj501_store_limits(), crypto::rd81opc96_store_limits());
    StoreFixture fixture{limits};
    REQUIRE(limits.max_rejected == 32);
    std::vector<std::string> thumbprints;
    for (int i = 0; i < 40; ++i) {
        const Certificate one = stranger();
        fixture.store.reject(one, in_seconds(i * 6));
        thumbprints.push_back(one.thumbprint_text());
        for (const auto& entry : fixture.store.list(StoreList::Rejected)) {
            if (entry.thumbprint == one.thumbprint_text()) {
                set_age(fixture.path(entry.file), std::chrono::seconds{1'000 - i});
            }
        }
    }
    CHECK(fixture.count("rejected/certs") == 32);
    const bool is_discarded = limits.when_rejected_is_full == RejectedFull::Discard;
    const auto first = thumbprints.begin() + (is_discarded ? 0 : 8);
    CHECK(fixture.in(StoreList::Rejected) == std::set<std::string>(first, first + 32));
    CHECK(fixture.log.count("was discarded") == 8);
    CHECK(fixture.log.count("was saved in rejected") == (is_discarded ? 32 : 40));
    // One that is known is not news.
    const std::size_t lines = fixture.log.lines.size();
    fixture.store.reject(*Certificate::parse_file([&] {
        std::ifstream file{fixture.path(fixture.store.list(StoreList::Rejected)[0].file)};
        const std::string text{std::istreambuf_iterator<char>{file}, {}};
        const auto bytes = std::as_bytes(std::span{text});
        return std::vector(bytes.begin(), bytes.end());
    }()),
                         in_days(1));
    CHECK(fixture.log.lines.size() == lines);
}

TEST_CASE("strangers wear out neither disk nor log", "[crypto][store][hostile]")
{
    StoreFixture fixture;
    const std::size_t limit = StoreLimits{}.max_rejected_per_minute;
    for (std::size_t i = 0; i < 3 * limit; ++i) {
        fixture.store.reject(stranger(), now);
    }
    CHECK(fixture.count("rejected/certs") == limit);
    CHECK(fixture.log.lines.size() == limit + 1);
    fixture.store.reject(stranger(), in_seconds(60));
    CHECK(fixture.count("rejected/certs") == limit + 1);
    fixture.store.reject(stranger(), in_days(-1)); // the clock went back
    CHECK(fixture.count("rejected/certs") == limit + 2);
}

TEST_CASE("strangers of one network leave others a place in rejected", "[crypto][store][hostile]")
{
    StoreFixture fixture;
    const std::size_t limit = StoreLimits{}.max_rejected_per_minute;
    for (std::size_t i = 0; i < 3 * limit; ++i) {
        fixture.store.reject(stranger(), now, "192.0.2.66");
    }
    CHECK(fixture.count("rejected/certs") == 3); // a quarter of 10
    CHECK(fixture.log.count("more strangers from 192.0.2.66") == 1);
    const Certificate client = stranger();
    fixture.store.reject(client, now, "192.0.2.7");
    CHECK(fixture.in(StoreList::Rejected).contains(client.thumbprint_text()));
    // All networks together keep to the limit, and so do those that are known by no source.
    for (std::size_t i = 0; i < limit; ++i) {
        fixture.store.reject(stranger(), now, "2001:db8:" + std::to_string(i) + "::");
        fixture.store.reject(stranger(), now);
    }
    CHECK(fixture.count("rejected/certs") == limit);
    fixture.store.reject(stranger(), in_seconds(60), "192.0.2.66");
    CHECK(fixture.count("rejected/certs") == limit + 1);
}

TEST_CASE("a crowd of other files in rejected stops the saving", "[crypto][store][hostile]")
{
    StoreLimits limits;
    limits.max_files = 5;
    StoreFixture fixture{limits};
    for (int i = 0; i < 6; ++i) {
        write_text(fixture.path("rejected/certs/" + std::to_string(i)), "x");
    }
    fixture.store.reject(stranger(), now);
    CHECK(fixture.count("rejected/certs") == 6);
    limits.max_rejected = 0;
    StoreFixture none{limits};
    none.store.reject(stranger(), now);
    CHECK(none.count("rejected/certs") == 0);
    CHECK(none.log.count("was discarded") == 1);
    fs::remove_all(none.path("rejected"));
    none.store.reject(stranger(), now);
    CHECK(fixture.log.lines.size() >= 1);
}

} // namespace store_files_test

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/file_transaction.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "revoking.hpp"

namespace store_record_test {

using namespace busbar;
using namespace busbar::test;
using crypto::CertificateStore;
using crypto::StoreList;

namespace {

/// "CertificateAdded ListName=trusted": kinds and fields that are texts or times.
class RecordEar final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view) override {}
    bool wants(RecordKind) const override { return true; }
    void record(const Record& record) override
    {
        std::string line{name(record.kind)};
        for (const RecordField& each : record.fields) {
            const auto* const time = each.value.get_if<DateTime>();
            line += " " + std::string{each.name} + "=" +
                    (time != nullptr ? to_string(*time) : each.value.value_or(String{}).str());
        }
        records.push_back(line + (record.certificate.empty() ? "" : " DER"));
    }

    std::vector<std::string> records;
};

using Lines = std::vector<std::string>;

struct RecordedStore {
    RecordedStore() { REQUIRE(store.create()); }

    /// As somebody does who has the folders before him.
    void put(std::string_view file, std::span<const std::byte> contents)
    {
        REQUIRE(storage.replace(file, contents, FileAccess::Everyone));
    }
    /// What is told of the folders since it was last asked for, sorted.
    Lines look()
    {
        ear.records.clear();
        store.tell_found_changes(now);
        std::ranges::sort(ear.records);
        return ear.records;
    }

    storage::MemoryStorage storage;
    RecordEar ear;
    CertificateStore store{storage, {}, ear};
};

/// A medium that does not answer.
class FailingStorage final : public StorageFolder {
public:
    explicit FailingStorage(Storage& storage) : StorageFolder{storage, ""} {}

    Stored<std::size_t> read(std::string_view name, std::uint64_t offset,
                             std::span<std::byte> into) override
    {
        return fails_files ? Stored<std::size_t>{Unexpected{StorageError::Failed}}
                           : StorageFolder::read(name, offset, into);
    }
    Stored<StorageListing> list(std::string_view folder, std::size_t most) override
    {
        return fails_folders ? Stored<StorageListing>{Unexpected{StorageError::Failed}}
                             : StorageFolder::list(folder, most);
    }

    bool fails_files{false};
    bool fails_folders{false};
};

/// Somebody moves a file just before a folder is listed.
class MovingStorage final : public StorageFolder {
public:
    explicit MovingStorage(Storage& storage) : StorageFolder{storage, ""} {}

    Stored<StorageListing> list(std::string_view folder, std::size_t most) override
    {
        if (folder == before) {
            before = {};
            REQUIRE(StorageFolder::move(from, to, WhenThere::Replace));
        }
        return StorageFolder::list(folder, most);
    }

    std::string_view before;
    std::string_view from;
    std::string_view to;
};

} // namespace

TEST_CASE_METHOD(RecordedStore, "records say of revocation lists what logs need", "[crypto][store]")
{
    const Issued root = issue(authority("root"), key_number(2));
    const auto list = revoke(root);
    const std::string thumbprint = list.thumbprint_text();
    REQUIRE(store.add(StoreList::Issuers, list.der()));
    REQUIRE(store.move(thumbprint, StoreList::Issuers, StoreList::Trusted));
    REQUIRE(store.remove(StoreList::Trusted, thumbprint));
    const std::string rest =
        " FileName=root [" + thumbprint + "].crl IssuerName=root NextUpdate=2026-01-31T00:00:00Z";
    CHECK(ear.records == Lines{"RevocationListAdded ListName=issuers" + rest,
                               "RevocationListAdded ListName=trusted FromListName=issuers" + rest,
                               "RevocationListRemoved ListName=trusted" + rest});
}

TEST_CASE_METHOD(RecordedStore, "what comes into the folders and goes is told once",
                 "[crypto][store]")
{
    const Issued one = issue(authority("one"), key_number(1));
    const Issued two = issue(authority("two"), key_number(2));
    const auto list = revoke(two);
    put("trusted/certs/one.der", one.certificate.der());
    CHECK(look().empty()); // as it is
    put("issuers/certs/two.der", two.certificate.der());
    put("issuers/crl/two.crl", list.der());
    const std::string of_list = " FileName=two.crl IssuerName=two NextUpdate=2026-01-31T00:00:00Z";
    CHECK(look() == Lines{"CertificateAdded ListName=issuers DER",
                          "RevocationListAdded ListName=issuers" + of_list});
    CHECK(look().empty());
    REQUIRE(storage.remove("issuers/certs/two.der"));
    REQUIRE(storage.remove("issuers/crl/two.crl"));
    REQUIRE(storage.remove("trusted/certs/one.der"));
    CHECK(look() == Lines{"CertificateRemoved ListName=issuers DER",
                          "CertificateRemoved ListName=trusted DER",
                          "RevocationListRemoved ListName=issuers" + of_list});
    CHECK(look().empty());
}

TEST_CASE_METHOD(RecordedStore, "a file that changes its folder is told as moved",
                 "[crypto][store]")
{
    const Issued one = issue(authority("one"), key_number(1));
    CHECK(look().empty());
    store.reject(one.certificate, now);
    CHECK(look().empty());
    const auto file = store.list(StoreList::Rejected).front().file;
    REQUIRE(storage.move(file, "trusted/certs/one.der", WhenThere::Replace));
    CHECK(look() == Lines{"CertificateMoved ListName=trusted FromListName=rejected DER"});
    REQUIRE(storage.move("trusted/certs/one.der", "trusted/one.cer", WhenThere::Replace));
    CHECK(look().empty()); // another file of the same list
    REQUIRE(storage.remove("trusted/one.cer"));
    CHECK(look() == Lines{"CertificateRemoved ListName=trusted DER"});
}

TEST_CASE_METHOD(RecordedStore, "a file that is moved while the lists are read is told as moved",
                 "[crypto][store]")
{
    const Issued one = issue(authority("one"), key_number(1));
    put("rejected/certs/one.der", one.certificate.der());
    MovingStorage moving{storage};
    CertificateStore looking{moving, {}, ear};
    looking.tell_found_changes(now);
    moving.before = "rejected/certs"; // the last one
    moving.from = "rejected/certs/one.der";
    moving.to = "issuers/certs/one.der";
    looking.tell_found_changes(now);
    looking.tell_found_changes(now);
    CHECK(ear.records == Lines{"CertificateMoved ListName=issuers FromListName=rejected DER"});

    ear.records.clear();
    moving.before = "rejected/certs"; // after the list in which it was
    moving.from = "issuers/certs/one.der";
    moving.to = "rejected/certs/one.der";
    looking.tell_found_changes(now);
    looking.tell_found_changes(now);
    CHECK(ear.records == Lines{"CertificateMoved ListName=rejected FromListName=issuers DER"});
}

TEST_CASE_METHOD(RecordedStore, "strangers are not discarded where the lists wait for a restart",
                 "[crypto][store]")
{
    const Issued one = issue(authority("one"), key_number(1));
    StorageGate gate{storage};
    CertificateStore closed{gate, {}, ear};
    gate.close();
    closed.reject(one.certificate, now);
    CHECK(ear.records.empty());
    CHECK(closed.list(StoreList::Rejected).empty());
}

TEST_CASE_METHOD(RecordedStore, "what the store does itself is not told again as found",
                 "[crypto][store]")
{
    const Issued one = issue(authority("one"), key_number(1));
    const Issued two = issue(authority("two"), key_number(2));
    CHECK(look().empty());
    REQUIRE(store.add(StoreList::Trusted, one.certificate.der()));
    CHECK(look().empty());
    REQUIRE(store.move(one.certificate.thumbprint_text(), StoreList::Trusted, StoreList::Issuers));
    CHECK(look().empty());
    REQUIRE(store.remove(StoreList::Issuers, one.certificate.thumbprint_text()));
    CHECK(look().empty());
    const crypto::TrustList before = store.trust_list(now);
    crypto::TrustList after = before;
    after.trusted = {two.certificate};
    FileTransaction change{storage, "change"};
    REQUIRE(store.stage(after, {true, true, true, true}, change));
    REQUIRE(change.commit());
    store.tell_changes(before, after);
    CHECK(ear.records.back() == "CertificateAdded ListName=trusted DER");
    CHECK(look().empty());
}

TEST_CASE("the oldest rejected certificate that gives way is told once", "[crypto][store]")
{
    storage::MemoryStorage storage;
    RecordEar ear;
    crypto::StoreLimits limits;
    limits.max_rejected = 1;
    CertificateStore store{storage, limits, ear};
    REQUIRE(store.create());
    store.tell_found_changes(now);
    store.reject(issue(authority("one"), key_number(1)).certificate, now);
    store.reject(issue(authority("two"), key_number(2)).certificate, now);
    ear.records.clear();
    store.tell_found_changes(now);
    CHECK(ear.records.empty());
}

TEST_CASE("a certificate in a file that cannot be read is not told as gone", "[crypto][store]")
{
    storage::MemoryStorage storage;
    storage.set_time(now); // fresh files are read each time
    FailingStorage failing{storage};
    RecordEar ear;
    CertificateStore store{failing, {}, ear};
    REQUIRE(store.create());
    REQUIRE(
        store.add(StoreList::Trusted, issue(authority("one"), key_number(1)).certificate.der()));
    ear.records.clear();
    store.tell_found_changes(now);
    failing.fails_files = GENERATE(false, true);
    failing.fails_folders = !failing.fails_files;
    store.tell_found_changes(now);
    CHECK(store.trust_list(now).trusted.empty());
    failing.fails_files = false;
    failing.fails_folders = false;
    store.tell_found_changes(now);
    CHECK(ear.records.empty());
}

TEST_CASE_METHOD(RecordedStore, "a certificate is told as refused before it is told as saved",
                 "[crypto][store]")
{
    crypto::StoreValidator validator{store, ear};
    crypto::ValidationContext context;
    context.policy = crypto::find_policy_by_name("Basic256Sha256");
    context.now = now;
    CHECK_FALSE(validator.validate({issue({}, key_number(1)).certificate}, context));
    CHECK(ear.records == Lines{"CertificateRefused DER", "CertificateSaved DER"});
}

} // namespace store_record_test

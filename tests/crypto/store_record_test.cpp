#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <busbar/core/record.hpp>
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

    storage::MemoryStorage storage;
    RecordEar ear;
    CertificateStore store{storage, {}, ear};
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

#include <busbar/crypto/store_validator.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/record.hpp>

namespace busbar::crypto {

namespace {

/// True for a status that an administrator can cure by moving the certificate, or wants to know of.
bool is_worth_keeping(StatusCode code)
{
    constexpr std::array codes = {
        status::Bad_CertificateUntrusted, status::Bad_CertificateChainIncomplete,
        status::Bad_CertificateRevoked, status::Bad_CertificateIssuerRevoked};
    return std::find(codes.begin(), codes.end(), code) != codes.end();
}

Record record_of(RecordKind kind, const Refusal& refusal, const CertificateChain& chain)
{
    Record record{kind, LogLevel::Info, "certificate"};
    record.status = refusal.status;
    record.refusal = &refusal;
    if (!chain.empty()) {
        record.certificate = chain.front().der();
    }
    return record;
}

} // namespace

StoreValidator::StoreValidator(CertificateStore& store, LogSink& log,
                               const ValidationSettings& settings)
    : store_{&store}, log_{&log}, settings_{settings}
{
}

Checked<void> StoreValidator::validate(const CertificateChain& chain,
                                       const ValidationContext& context)
{
    suppressed_.clear();
    auto refusal =
        check_chain(chain, store_->trust_list(context.now), context, settings_, &suppressed_);
    if (refusal) {
        // The code that answers the peer writes the line.
        if (log_->wants(RecordKind::CertificateRefused)) {
            log_->record(record_of(RecordKind::CertificateRefused, *refusal, chain));
        }
        if (!chain.empty() && is_worth_keeping(refusal->status)) {
            store_->reject(chain.front(), context.now, context.source);
        }
        return refuse(*std::move(refusal));
    }
    for (const Refusal& passed : suppressed_) {
        Record record = record_of(RecordKind::CertificateSuppressed, passed, chain);
        record.text = "accepted by a setting: " + text(passed);
        tell(*log_, record);
    }
    return {};
}

} // namespace busbar::crypto

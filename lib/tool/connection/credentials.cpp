#include "credentials.hpp"

#include <busbar/core/status_codes.hpp>

namespace busbar::tool {

Credentials::Credentials(Context& context, LogSink& log) : context_{&context}
{
    try {
        open(log);
    } catch (const Failure& failure) {
        if (!context.options.is_insecure) {
            throw;
        }
        missing_ = failure;
    }
}

void Credentials::open(LogSink& log)
{
    pki_.emplace(context_->options, log);
    identity_ = pki_->identity();
    trust_.emplace(*pki_, *context_, log);
}

Checked<void> Credentials::validate(const crypto::CertificateChain& chain,
                                    const crypto::ValidationContext& context)
{
    was_asked_ = true;
    if (trust_) {
        return trust_->validate(chain, context);
    }
    return refuse({status::Bad_CertificateUntrusted, "Trust List Check", missing_->what(),
                   "Part 4, 6.1.3, Table 100", missing_->hint});
}

std::string Credentials::application_uri() const
{
    return identity_ ? identity_->certificates.front().application_uri() : Pki::application_uri();
}

bool Credentials::has_refused() const
{
    return trust_ ? trust_->has_refused() : was_asked_;
}

bool Credentials::reconsider()
{
    return trust_ && trust_->reconsider(*context_);
}

Failure Credentials::failure() const
{
    return trust_ ? trust_->failure() : *missing_;
}

} // namespace busbar::tool

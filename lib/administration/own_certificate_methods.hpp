#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/problem.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "node_table.hpp"
#include "permissions.hpp"
#include "transaction.hpp"

namespace busbar::administration::detail {

/// The parts of ServerConfiguration that the Methods for the own certificate use.
struct OwnCertificateNeeds {
    server::Server& server;
    const ManagedCertificates& files;
    NodeTable& table;
    const WallClock& clock;
    LogSink& log;
    /// Generates keys; if null, the server's thread does.
    server::Worker* worker;
    Transaction& transaction;
};

/// The Methods of ServerConfiguration for the server's own certificate (Part 12, 7.10.5 to 7.10.8
/// and 7.10.10). There is one slot: an RSA certificate of DefaultApplicationGroup.
class OwnCertificateMethods {
public:
    explicit OwnCertificateMethods(const OwnCertificateNeeds& needs) : needs_{needs} {}

    /// While this is true, nothing else may use the own certificate's files.
    [[nodiscard]] bool is_making_key() const { return !making_key_.expired(); }

    void update(server::MethodCall call);
    void create_signing_request(server::MethodCall call);
    void create_self_signed(server::MethodCall call);
    void remove(server::MethodCall call);
    void get(server::MethodCall call);

private:
    /// Good if the inputs name the slot.
    [[nodiscard]] StatusCode check_slot(const server::MethodCall& call) const;
    /// Makes the certificate, with its issuers and its key, from the inputs.
    [[nodiscard]] Checked<crypto::OwnCertificate> own_of(const server::MethodCall& call) const;
    [[nodiscard]] Checked<void> check_own(const crypto::OwnCertificate& own) const;
    /// Runs `work` where keys are generated, then `finish` on the server's thread. If there is no
    /// room for the work, it throws, the client gives up, or its user loses the right or the
    /// session, the call fails instead.
    void run_slowly(const std::shared_ptr<server::MethodCall>& call, std::function<void()> work,
                    std::function<void()> finish);
    /// Returns Good if the client still waits and its user still has the right.
    [[nodiscard]] StatusCode check_wanted(const server::MethodCall& call,
                                          const Holder& holder) const;
    void refuse_call(server::MethodCall& call, const Refusal& refusal);
    /// Answers the call if the own certificate may not be replaced now.
    [[nodiscard]] bool refuses_another(server::MethodCall& call);

    OwnCertificateNeeds needs_;
    /// Not expired while a key is being generated, however that ends.
    std::weak_ptr<const void> making_key_;
};

/// Replaces the fields of `subject` by those of a subject name: "CN=Press 4/O=Works", separated by
/// "/" or ",", with a value that has one of these in double quotes (Part 12, 7.9.4). An empty text
/// changes nothing. Bad_InvalidArgument for any other text.
[[nodiscard]] Checked<crypto::CertificateSubject> with_names(crypto::CertificateSubject subject,
                                                             std::string_view text);

/// Writes the names of a subject as with_names() reads them; empty if it has none.
[[nodiscard]] std::string text_of_names(const crypto::CertificateSubject& subject);

/// Shows the server's own certificate as the Object "OwnCertificate" below ServerConfiguration, in
/// the server's namespace, with the facts that W588, 3-2-5 lists. It has the access rights of
/// ServerConfiguration's Properties. ConfiguredSubject and ConfiguredHosts have the values of
/// `configured` (see ManagedCertificates); without that they do not exist.
[[nodiscard]] Configured<void>
add_own_certificate(server::Server& server, NodeTable& table,
                    const std::function<crypto::CertificateSubject()>& configured);

} // namespace busbar::administration::detail

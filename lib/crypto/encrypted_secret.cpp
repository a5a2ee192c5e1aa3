#include <busbar/crypto/encrypted_secret.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>

#include <busbar/crypto/random.hpp>
#include <busbar/crypto/symmetric.hpp>

namespace busbar::crypto {

namespace {

/// The NodeId of the DataType, i=17545, in the two encodings that it may have (Part 6, 5.2.2.9),
/// and the mask of a body that is a ByteString.
constexpr std::byte four_byte_id[]{std::byte{0x01}, std::byte{0x00}, std::byte{0x89},
                                   std::byte{0x44}, std::byte{0x01}};
constexpr std::byte numeric_id[]{std::byte{0x02}, std::byte{0x00}, std::byte{0x00},
                                 std::byte{0x89}, std::byte{0x44}, std::byte{0x00},
                                 std::byte{0x00}, std::byte{0x01}};

bool begins_with(std::span<const std::byte> data, std::span<const std::byte> head)
{
    return data.size() >= head.size() && std::ranges::equal(data.first(head.size()), head);
}

void put_number(Bytes& to, std::uint64_t number, unsigned size)
{
    for (unsigned shift = 0; shift < 8 * size; shift += 8) {
        to.push_back(static_cast<std::byte>(number >> shift));
    }
}

void put_bytes(Bytes& to, std::span<const std::byte> bytes)
{
    put_number(to, bytes.size(), 4);
    to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Reads from the front; after a failure it returns nothing more.
class Fields {
public:
    explicit Fields(std::span<const std::byte> bytes) : rest_{bytes} {}

    [[nodiscard]] bool has_failed() const { return has_failed_; }
    [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }
    std::span<const std::byte> take(std::size_t size)
    {
        if (size > rest_.size()) {
            has_failed_ = true;
            rest_ = {};
            return {};
        }
        const auto taken = rest_.first(size);
        rest_ = rest_.subspan(size);
        return taken;
    }
    std::uint64_t number(std::size_t size)
    {
        std::uint64_t number = 0;
        const auto bytes = take(size);
        for (std::size_t i = bytes.size(); i > 0; --i) {
            number = number << 8 | std::to_integer<std::uint64_t>(bytes[i - 1]);
        }
        return number;
    }
    /// A String or ByteString.
    std::span<const std::byte> bytes() { return take(static_cast<std::size_t>(number(4))); }

private:
    std::span<const std::byte> rest_;
    bool has_failed_{false};
};

/// Size of KeyData before encryption: three ByteStrings whose sizes the policy sets.
std::size_t key_data_size(const SecurityPolicy& policy)
{
    return 12 + policy.signing_key_size + policy.encrypting_key_size + policy.block_size;
}

/// The parts that can be separated without a key.
struct SealedParts {
    std::span<const std::byte> key_data;
    std::span<const std::byte> payload;
    std::span<const std::byte> signed_part;
    std::span<const std::byte> signature;
};

std::optional<SealedParts> sealed_parts(const SecurityPolicy& policy,
                                        const Certificate& certificate,
                                        std::span<const std::byte> data)
{
    Fields fields{data};
    fields.take(begins_with(data, four_byte_id) ? sizeof four_byte_id : sizeof numeric_id);
    const std::uint64_t length = fields.number(4);
    const bool is_whole = !fields.has_failed() && length == fields.rest().size();
    const auto uri = fields.bytes();
    const auto thumbprint = fields.bytes();
    fields.take(8); // SigningTime
    SealedParts parts;
    parts.key_data = fields.take(static_cast<std::size_t>(fields.number(2)));
    const std::size_t key_size = certificate.key_size();
    const std::size_t block = plain_block_size(policy, key_size);
    const std::size_t sign_size = policy.symmetric_signature_size;
    const std::size_t rest = fields.rest().size();
    if (!is_encrypted_secret(data) || !is_whole || fields.has_failed() || policy.is_none() ||
        block == 0 || !std::ranges::equal(uri, std::as_bytes(std::span{policy.uri})) ||
        !std::ranges::equal(thumbprint, certificate.thumbprint()) ||
        parts.key_data.size() != (key_data_size(policy) + block - 1) / block * key_size ||
        rest <= sign_size || (rest - sign_size) % policy.block_size != 0) {
        return std::nullopt;
    }
    parts.payload = fields.rest().first(rest - sign_size);
    parts.signature = fields.rest().last(sign_size);
    parts.signed_part = data.first(data.size() - sign_size);
    return parts;
}

/// Returns the keys; if there are none, the bytes in their places, with `is_good` set to false.
SymmetricKeys keys_in(const SecurityPolicy& policy, std::span<const std::byte> plain, bool& is_good)
{
    std::size_t at = 0;
    std::uint64_t differences = 0;
    const auto next = [&](std::size_t size) {
        Fields length{plain.subspan(at, 4)};
        differences |= length.number(4) ^ size;
        Secret key{plain.subspan(at + 4, size)};
        at += 4 + size;
        return key;
    };
    SymmetricKeys keys;
    keys.signing_key = next(policy.signing_key_size);
    keys.encrypting_key = next(policy.encrypting_key_size);
    keys.initialization_vector = next(policy.block_size);
    is_good = differences == 0;
    return keys;
}

/// Reads nonce, secret and padding. They were signed with the keys that came with them.
Result<Secret> secret_in(std::span<const std::byte> payload,
                         std::span<const std::byte> server_nonce, std::size_t max_size)
{
    Fields fields{payload};
    const auto nonce = fields.bytes();
    const auto secret = fields.bytes();
    const auto rest = fields.rest();
    if (fields.has_failed() || rest.size() < 2 || secret.size() > max_size ||
        !equal_in_constant_time(nonce, server_nonce)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const std::size_t padding = rest.size() - 2;
    const auto value = static_cast<std::byte>(padding);
    const auto is_padding = [&](std::byte byte) { return byte == value; };
    if (Fields{rest.last(2)}.number(2) != padding ||
        !std::ranges::all_of(rest.first(padding), is_padding)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return Secret{secret};
}

/// Part 6, 6.8.3: a short secret gets one more block, so that its size is hidden.
std::size_t padding_for(std::size_t data_size, std::size_t secret_size, std::size_t block)
{
    const std::size_t padding = (block - data_size % block) % block;
    return padding + secret_size < block ? padding + block : padding;
}

Bytes payload_of(const SecurityPolicy& policy, std::span<const std::byte> secret,
                 std::span<const std::byte> server_nonce)
{
    const std::size_t data_size = 4 + server_nonce.size() + 4 + secret.size() + 2;
    const std::size_t padding = padding_for(data_size, secret.size(), policy.block_size);
    Bytes payload;
    payload.reserve(data_size + padding); // growing would leave copies behind
    put_bytes(payload, server_nonce);
    put_bytes(payload, secret);
    payload.insert(payload.end(), padding, static_cast<std::byte>(padding));
    put_number(payload, padding, 2);
    return payload;
}

std::optional<SymmetricKeys> make_keys(const SecurityPolicy& policy)
{
    SymmetricKeys keys{Secret{policy.signing_key_size}, Secret{policy.encrypting_key_size},
                       Secret{policy.block_size}};
    SystemRandom random;
    for (Secret* const key :
         {&keys.signing_key, &keys.encrypting_key, &keys.initialization_vector}) {
        if (!random.fill(key->span())) {
            return std::nullopt;
        }
    }
    return keys;
}

Result<Bytes> encrypted_keys(const SecurityPolicy& policy, const Certificate& certificate,
                             const SymmetricKeys& keys)
{
    Bytes plain;
    plain.reserve(key_data_size(policy));
    put_bytes(plain, keys.signing_key.span());
    put_bytes(plain, keys.encrypting_key.span());
    put_bytes(plain, keys.initialization_vector.span());
    auto cipher = asymmetric_encrypt(policy, certificate, plain);
    cleanse(plain);
    return cipher;
}

} // namespace

bool is_encrypted_secret(std::span<const std::byte> data)
{
    return begins_with(data, four_byte_id) || begins_with(data, numeric_id);
}

Result<Bytes> seal_secret(const SecurityPolicy& policy, const Certificate& certificate,
                          std::span<const std::byte> secret,
                          std::span<const std::byte> server_nonce, DateTime now)
{
    if (policy.is_none() || server_nonce.size() < min_server_nonce_size) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto keys = make_keys(policy);
    if (!keys) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto key_data = encrypted_keys(policy, certificate, *keys);
    auto cipher = SymmetricCipher::create(policy, *keys);
    if (!key_data || !cipher) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    Bytes payload = payload_of(policy, secret, server_nonce);
    if (!cipher->encrypt(payload)) {
        cleanse(payload);
        return fail(status::Bad_SecurityChecksFailed);
    }
    Bytes sealed{std::begin(four_byte_id), std::end(four_byte_id)};
    const std::vector<std::byte> thumbprint = certificate.thumbprint();
    const std::size_t length = 4 + policy.uri.size() + 4 + thumbprint.size() + 8 + 2 +
                               key_data->size() + payload.size() + policy.symmetric_signature_size;
    put_number(sealed, length, 4);
    put_bytes(sealed, std::as_bytes(std::span{policy.uri}));
    put_bytes(sealed, thumbprint);
    put_number(sealed, static_cast<std::uint64_t>(now.ticks), 8);
    put_number(sealed, key_data->size(), 2);
    sealed.insert(sealed.end(), key_data->begin(), key_data->end());
    sealed.insert(sealed.end(), payload.begin(), payload.end());
    const std::size_t signed_size = sealed.size();
    sealed.resize(signed_size + policy.symmetric_signature_size);
    const std::span all{sealed};
    if (!cipher->sign(all.first(signed_size), all.subspan(signed_size))) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return sealed;
}

Result<Secret> unseal_secret(const SecurityPolicy& policy, const Certificate& certificate,
                             const PrivateKey& key, std::span<const std::byte> data,
                             std::span<const std::byte> server_nonce, std::size_t max_size)
{
    const auto parts = sealed_parts(policy, certificate, data);
    if (!parts || server_nonce.size() < min_server_nonce_size) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    auto plain = asymmetric_decrypt(policy, key, parts->key_data);
    if (!plain || plain->size() < key_data_size(policy)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    // From here on a failure must not disclose which step failed: random bytes in place of
    // decrypted ones take the same way.
    bool is_good = false;
    const SymmetricKeys keys = keys_in(policy, *plain, is_good);
    cleanse(*plain);
    auto cipher = SymmetricCipher::create(policy, keys);
    if (!cipher) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const bool is_signed = cipher->verify(parts->signed_part, parts->signature);
    Secret payload{parts->payload};
    const bool is_decrypted = cipher->decrypt(payload.span());
    if (!(is_good & is_signed & is_decrypted)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return secret_in(payload.span(), server_nonce, max_size);
}

} // namespace busbar::crypto

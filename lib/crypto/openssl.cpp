#include "openssl.hpp"

#include <chrono>
#include <climits>
#include <ctime>

namespace busbar::crypto::detail {

Bio memory_bio(std::span<const std::byte> bytes)
{
    if (bytes.size() > static_cast<std::size_t>(INT_MAX)) {
        return nullptr;
    }
    return Bio{BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size()))};
}

int give_no_passphrase(char*, int, int, void*)
{
    return -1;
}

DateTime date_time_of(const ASN1_TIME* time)
{
    std::tm parts{};
    if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) {
        return {};
    }
    // Not with timegm(): a time_t of 32 bits ends in 2038.
    using namespace std::chrono;
    const sys_days day = year{parts.tm_year + 1900} / (parts.tm_mon + 1) / parts.tm_mday;
    const sys_seconds moment =
        sys_seconds{day} + hours{parts.tm_hour} + minutes{parts.tm_min} + seconds{parts.tm_sec};
    return DateTime::from_unix_seconds(moment.time_since_epoch().count());
}

bool set_time(ASN1_TIME* to, DateTime time)
{
    constexpr std::size_t up_to_seconds = 19; // of 2026-11-21T06:00:00.5Z
    std::string digits = to_string(time).substr(0, up_to_seconds);
    std::erase_if(digits, [](char c) { return c < '0' || c > '9'; });
    return ASN1_TIME_set_string_X509(to, (digits + "Z").c_str()) == 1;
}

std::string text_of(const X509_NAME* name)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    if (!bio || X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_ONELINE & ~XN_FLAG_SPC_EQ) < 0) {
        return {};
    }
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio.get(), &text);
    return size <= 0 ? std::string{} : std::string{text, static_cast<std::size_t>(size)};
}

bool names_one_algorithm(const X509_CRL* list, std::span<const std::byte> der)
{
    const unsigned char* at = bytes_of(der);
    const unsigned char* const end = at + der.size();
    // Enters an object of this type, or skips it, if it is the next one.
    const auto pass = [&](int expected, bool whole) {
        const unsigned char* next = at;
        long size = 0;
        int tag = 0;
        int object_class = 0;
        const int form = ASN1_get_object(&next, &size, &tag, &object_class, end - at);
        if ((form & 0x80) != 0 || tag != expected || object_class != V_ASN1_UNIVERSAL) {
            return false;
        }
        at = whole ? next + size : next;
        return true;
    };
    // OpenSSL returns the signed algorithm of certificates, but not that of lists.
    const bool is_list = pass(V_ASN1_SEQUENCE, false) && pass(V_ASN1_SEQUENCE, false);
    pass(V_ASN1_INTEGER, true); // the version, if it is not 1
    const Algorithm is_signed{is_list ? d2i_X509_ALGOR(nullptr, &at, end - at) : nullptr};
    const X509_ALGOR* beside = nullptr;
    X509_CRL_get0_signature(list, nullptr, &beside);
    return is_signed && beside != nullptr && X509_ALGOR_cmp(is_signed.get(), beside) == 0;
}

std::vector<std::byte> sha1_of(std::span<const std::byte> bytes)
{
    std::vector<std::byte> digest(20);
    EVP_Digest(bytes.data(), bytes.size(), bytes_of(std::span{digest}), nullptr, EVP_sha1(),
               nullptr);
    return digest;
}

std::string hexadecimal(std::span<const std::byte> bytes)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (const std::byte byte : bytes) {
        text += digits[std::to_integer<unsigned>(byte) >> 4U];
        text += digits[std::to_integer<unsigned>(byte) & 15U];
    }
    return text;
}

} // namespace busbar::crypto::detail

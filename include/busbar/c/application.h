/* The application around servers and clients of the C interface: its names, certificate, trust and
 * log. See busbar/busbar.h for what holds for all functions. */
#ifndef BUSBAR_C_APPLICATION_H
#define BUSBAR_C_APPLICATION_H

#include <busbar/c/value.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BUSBAR_LOG_DEBUG = 0, BUSBAR_LOG_INFO = 1, BUSBAR_LOG_WARNING = 2, BUSBAR_LOG_ERROR = 3 };

/* Gets the lines of a log, called from any thread. `source` is the part of the library; both texts
 * are printable, without secrets, terminated, and valid during the call. Must not call Busbar. */
typedef void (*busbar_log_callback)(void* context, int level, const char* source, const char* text);

/* Describes an application: names, certificate, trust and log. With a folder, certificate, key and
 * trust lists lie there (Part 12, F.1); what is missing is created, which takes seconds for a key.
 * Without a folder they are memory, and the key is not written anywhere: for a machine without
 * files. With neither, only SecurityPolicy None works. */
typedef struct busbar_application {
    const char* uri;       /* globally unique; the certificate contains it. Required. */
    const char* name;      /* of the application; the uri if null */
    const char* host_name; /* in a new certificate and of the endpoint; "localhost" if null */
    const char* folder;
    /* DER or PEM, and the RSA key, PKCS#1 or PKCS#8. */
    const void* certificate;
    size_t certificate_size;
    const void* key;
    size_t key_size;
    /* `trusted_count` certificates or authorities, DER or PEM, that are trusted without a folder.
     */
    const busbar_text* trusted;
    size_t trusted_count;
    busbar_log_callback log; /* null: none */
    void* log_context;
    int log_level; /* the least level that is passed on */
} busbar_application;

/* MessageSecurityMode (Part 4, 7.20). */
enum { BUSBAR_MODE_NONE = 1, BUSBAR_MODE_SIGN = 2, BUSBAR_MODE_SIGN_AND_ENCRYPT = 3 };

#ifdef __cplusplus
}
#endif

#endif

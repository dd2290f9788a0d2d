/* Preloaded, it refuses what some storages refuse, by the words in PAROS_REFUSE: `folder-sync` the fsync of a folder,
 * with EINVAL, and `link` every hard link, with EPERM. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static int refuses(const char *word)
{
    const char *words = getenv("PAROS_REFUSE");
    return words && strstr(words, word);
}

int fsync(int file)
{
    struct stat found;
    if (refuses("folder-sync") && fstat(file, &found) == 0 && S_ISDIR(found.st_mode)) {
        errno = EINVAL;
        return -1;
    }
    return syscall(SYS_fsync, file);
}

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags)
{
    if (refuses("link")) {
        errno = EPERM;
        return -1;
    }
    return syscall(SYS_linkat, from_folder, from, to_folder, to, flags);
}

int link(const char *from, const char *to)
{
    return linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}

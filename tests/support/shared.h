/* Where reference data lie beside the checkout, for tests that can do without them. */
#ifndef FG_TESTS_SHARED_H
#define FG_TESTS_SHARED_H

#include <stdio.h>
#include <stdlib.h>

enum { TEST_SKIPPED = 77 };

/* $FOILGAUGE_SHARED, or ../shared, and the rest of the path. */
static inline void shared_path(char *path, size_t size, const char *rest) {
  const char *folder = getenv("FOILGAUGE_SHARED");
  snprintf(path, size, "%s/%s", folder ? folder : "../shared", rest);
}

/* The whole file, NUL-terminated, or NULL. The caller frees it. */
static inline char *shared_read(const char *rest, size_t *length) {
  char path[600];
  shared_path(path, sizeof path, rest);
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  char *text = NULL;
  if (fseek(file, 0, SEEK_END) == 0) {
    long size = ftell(file);
    rewind(file);
    text = size >= 0 ? malloc((size_t)size + 1) : NULL;
    if (text) {
      *length = fread(text, 1, (size_t)size, file);
      text[*length] = 0;
    }
  }
  fclose(file);
  return text;
}

#endif

/* Counts what the ranks of a program send each other; loaded before the MPI library (LD_PRELOAD). Point-to-point messages, those without content, bytes,
   collective calls, and the bytes that they reduce. Built and read by measure.py. */
#include <mpi.h>

long fsi_messages, fsi_empty, fsi_bytes, fsi_collectives, fsi_reduced;

static void sent(int count, MPI_Datatype type)
{
  int size;
  PMPI_Type_size(type, &size);
  fsi_messages++;
  fsi_empty += count == 0;
  fsi_bytes += (long) count * size;
}

int MPI_Send(const void *buf, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
  sent(count, type);
  return PMPI_Send(buf, count, type, to, tag, comm);
}

int MPI_Isend(const void *buf, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request *request)
{
  sent(count, type);
  return PMPI_Isend(buf, count, type, to, tag, comm, request);
}

int MPI_Sendrecv(const void *buf, int count, MPI_Datatype type, int to, int tag, void *in, int nin, MPI_Datatype tin, int from, int tagin,
                 MPI_Comm comm, MPI_Status *status)
{
  sent(count, type);
  return PMPI_Sendrecv(buf, count, type, to, tag, in, nin, tin, from, tagin, comm, status);
}

int MPI_Allreduce(const void *buf, void *in, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  int size;
  PMPI_Type_size(type, &size);
  fsi_collectives++;
  fsi_reduced += (long) count * size;
  return PMPI_Allreduce(buf, in, count, type, op, comm);
}

int MPI_Bcast(void *buf, int count, MPI_Datatype type, int root, MPI_Comm comm)
{
  fsi_collectives++;
  return PMPI_Bcast(buf, count, type, root, comm);
}
